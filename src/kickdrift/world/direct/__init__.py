"""The direct solver: all rows of an island, of joints and contacts, solved simultaneously by sparse factorisation."""
