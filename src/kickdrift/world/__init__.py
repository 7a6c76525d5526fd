"""Worlds: rigid bodies that touch, stack, hinge and walk, with cloths, ropes and soft bodies among them.

Rooms, from a step to its solver:

- `world`: what users call; `bodies`, `joints`, `deformables`: adding, handles and rows of what moves; `shapes`: geometry.
- `step`: the order of the stages, their compilation, the loop that runs them, rollback and parts of steps.
- `collision`: broad phase, narrow phase (separating axes find contacts, EPA deep overlaps; there is no GJK), continuous
  detection (bullets), and queries. `collision.broad_phase.filters_and_sensors` has layers, `contact_events` reports sensors.
- `contacts`: constraints of contacts, and their sweeps; `contacts.impacts`: restitution, at its time within a step.
- `joints`: kinds of joints; limits, motors, drives and friction in them; articulations and loops. Joints have no rows that
  sweeps solve: `joints.right_hand_side` has their errors, and `direct.factorisation` eliminates their axes.
- `direct`: what sweeps do not bring to convergence, solved simultaneously: islands with joints, mass ratios and stacks.
- `integration`, `free_rotation`: kick and drift; `forces`, `force_functions`: what users apply.
- `kickdrift.io.robots`: robots from MJCF and URDF.
- `sleeping`; `recordings`, `snapshot`: histories and states; `tables`, `columns`, `layout`: data, as compiled code sees them.
"""
