"""The direct solver: all rows of an island at once, those of joints and those of contacts, by a sparse factorisation."""
