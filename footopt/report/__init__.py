"""Figures, films, pages and terminal output. Only this package imports matplotlib."""
