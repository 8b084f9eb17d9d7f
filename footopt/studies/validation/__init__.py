"""Experiments on sand by other people, as data (one TOML file each), and the rig that repeats them."""
