"""Contacts of cloths, ropes and soft bodies with the shapes of bodies."""
