"""Features of a part by ids: their list, proposals of characteristics on them, and characteristics stated on them."""
