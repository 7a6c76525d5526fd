"""The contacts of a world as its users see them."""

import numpy as np
from numpy.typing import NDArray

from kickdrift.world.bodies.handle import Body
from kickdrift.world.bodies.registry import Bodies
from kickdrift.world.contact_events import ContactEvent, events, touching
from kickdrift.world.contact_points import Contact, contact_points, contacts
from kickdrift.world.tables import Tables


class ContactViews:
    """The attributes of a world about contacts after a step."""

    tables: Tables
    bodies: Bodies

    @property
    def events(self) -> list[ContactEvent]:
        """Contacts that began or ended in the last call of `step` or `advance`, in order; removing a body creates no event.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> floor = world.add_plane()
        >>> ball = world.add_sphere(radius=0.1, position=(0, 0, 0.2))
        >>> for _ in range(60):
        ...     world.step(1 / 60)
        ...     for event in world.events:
        ...         print(event.begins, event.body_b == ball, round(world.time, 3))
        True True 0.15
        """
        return events(self.tables, self.bodies)

    @property
    def touching(self) -> list[tuple[Body, Body]]:
        """Pairs of bodies that touch, each once."""
        return touching(self.tables, self.bodies)

    @property
    def contacts(self) -> list[Contact]:
        """Contacts at which bodies pressed on each other in the last step, with their forces; those of cloths are not included.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World(gravity=(3, 0, -9.81))
        >>> floor = world.add_plane()
        >>> box = world.add_box((1, 1, 1), position=(0, 0, 0.5), mass=2.0)
        >>> world.advance(1 / 60, 60)
        >>> [
        ...     (contact.body_b == box, len(contact.points), contact.force.round(2) + 0.0)
        ...     for contact in world.contacts
        ... ]
        [(True, 4, array([-6.  ,  0.  , 19.62]))]
        """
        with self.tables.lock:
            return contacts(self.tables, self.bodies)

    @property
    def contact_points(self) -> NDArray[np.float64]:
        """Points at which bodies pressed on each other in the last step, (P, 3), m; those of cloths are not included."""
        with self.tables.lock:
            return contact_points(self.tables)
