"""Effects beyond the plain law, one file each."""
