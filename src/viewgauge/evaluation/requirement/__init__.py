"""How accurately, and with what probability, a characteristic must be measured: one file a kind."""
