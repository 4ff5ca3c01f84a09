"""Files of calibrations as plain values: text to sections, the keys' names, and the account of every key."""
