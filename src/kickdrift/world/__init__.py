"""Worlds: rigid bodies that touch, stack, hinge and walk, with cloths, ropes and soft bodies among them.

Rooms, from a step to its solver:

- `world`: what users call; `bodies`, `joints`, `deformables`: adding, handles and rows of what moves; `shapes`: geometry.
- `step`: the order of the stages, their compilation, the loop that runs them, rollback and parts of steps.
- `collision`: broad phase, narrow phase (separating axes find contacts, EPA deep overlaps; there is no GJK), continuous
  detection (bullets), and queries. `collision.broad_phase.filters` has layers and sensors, `contact_events` reports them.
- `contacts`: constraints of contacts, and their sweeps; `contacts.impacts`: restitution, at its time within a step.
- `joints`: kinds of joints; limits, motors, drives and friction in them; articulations and loops.
- `direct`: what sweeps do not bring to convergence, solved simultaneously: islands with joints, mass ratios and stacks.
- `integration`, `free_rotation`: kick and drift; `forces`, `force_functions`: what users apply.
- `sleeping`; `recordings`, `snapshot`: histories and states; `tables`, `columns`, `layout`: data, as compiled code sees them.
"""
