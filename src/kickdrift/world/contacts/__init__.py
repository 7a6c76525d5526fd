"""Contacts: constraints that keep bodies apart, with friction and restitution."""
