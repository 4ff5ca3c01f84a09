"""Every file that is read or written, one folder a kind. Units are parsed and printed only here."""
