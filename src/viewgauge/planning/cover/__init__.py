"""The fewest viewpoints that cover every characteristic: exact minimum set cover, and the tour through them."""
