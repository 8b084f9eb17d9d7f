"""Files: what footopt reads and writes, to and from plain data."""
