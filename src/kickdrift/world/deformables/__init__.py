"""Deformable bodies: cloths, ropes and soft bodies, as particles that elastic forces connect."""
