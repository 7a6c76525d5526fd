"""Contacts: what keeps bodies apart."""
