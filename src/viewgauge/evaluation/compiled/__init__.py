"""The compiled loops over pairs of viewpoint and measurand: probabilities, columns of the table, the best measurand."""
