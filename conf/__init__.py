"""Settings, which Hydra finds as pkg://footopt.conf too: it asks that a package has this file."""
