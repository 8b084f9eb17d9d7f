"""report.html: what each kind of run shows in a browser; how it looks is in the files beside this one."""

from footopt.report.page.file import write, write_study
from footopt.report.page.walks import search_content, walk_content

__all__ = ["search_content", "walk_content", "write", "write_study"]
