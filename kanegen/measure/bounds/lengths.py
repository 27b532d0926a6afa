"""Bounds of the lengths of vectors, which turns keep; ranges of components alone grow with every turn.

Vectors are found in the steps: two sums are components of one vector if one turn makes both from the same two
values. The length of a sum of vectors is at most the sum of their lengths, and a factor that all components
share goes in front. Of all routes to a bound the best one is kept, to be used again for parts of a box.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from kanegen.measure.bounds.arithmetic import Step
from kanegen.measure.bounds.intervals import Intervals, up_product, up_sum
from kanegen.measure.bounds.relations import Component, Relations, Term
from kanegen.model.arrays import Floats
from kanegen.program.ir import Op

Components = tuple[Component, ...]
"""Up to three components of a vector, in any order."""

MOST_TERMS = 12
"""Most terms of a vector that is taken apart: there are many ways to do so, and few are good."""

_SLACK = 1 + 2.0**-50
"""More than the rounding errors of a root of a sum of three squares."""


@dataclass(frozen=True)
class Route:
    """A bound of a length: the sum of the lengths of parts, times the magnitude of a factor.

    Attributes:
        parts: Components of each part.
        factor: Number of the step that is the factor; None for 1.
    """

    parts: tuple[Components, ...]
    factor: int | None = None


class Routes:
    """The best routes, chosen by the magnitudes of values in one box, for this box and parts of it.

    Args:
        steps: Steps of a function.
        relations: Their structure.
    """

    def __init__(self, steps: Sequence[Step], relations: Relations) -> None:
        self._steps = steps
        self._relations = relations
        self._sizes: list[float] = []
        self._best: dict[Components, tuple[float, Route | None]] = {}

    def best(self, key: Components, exact: Sequence[Intervals]) -> Route | None:
        """Return the best route; None where the magnitudes of the components are the best bound.

        Args:
            key: Components of a vector.
            exact: Ranges of the values that are known so far.
        """
        self._sizes += [float(np.max(one.magnitude)) for one in exact[len(self._sizes) :]]
        self._estimate(key)
        return self._best[key][1]

    def _estimate(self, key: Components) -> float:
        """Return the length by the best route, without care for rounding."""
        if key not in self._best:
            self._best[key] = self._by_magnitudes(key), None
            for route in self._possible(key) if len(key) > 1 else ():
                length = sum(map(self._estimate, route.parts))
                length *= 1.0 if route.factor is None else self._sizes[route.factor]
                if length < self._best[key][0]:
                    self._best[key] = length, route
        return self._best[key][0]

    def _by_magnitudes(self, key: Components) -> float:
        """Return the length of a vector whose components have their largest magnitudes."""
        return math.hypot(*(sum(self._sizes[number] for _, number in component) for component in key))

    def _possible(self, key: Components) -> Iterator[Route]:
        """Yield routes to the length of a vector with two or three components and not too many terms."""
        if sum(map(len, key)) > MOST_TERMS:
            return
        yield from self._by_common_factor(key)
        yield from self._as_part_of_longer(key)
        yield from self._by_largest_terms(key)
        yield from self._before_turns(key)

    def _by_common_factor(self, key: Components) -> Iterator[Route]:
        """Yield the length of a vector of products, with the factor that they share in front."""
        values = [component[0][1] for component in key]
        if any(len(component) > 1 for component in key):
            return
        if any(self._steps[value].op is not Op.MULTIPLY for value in values):
            return
        for factor in set.intersection(*(set(self._steps[value].operands) for value in values)):
            pairs = [self._steps[value].operands for value in values]
            yield Route((_sorted(*(((1, b if a == factor else a),) for a, b in pairs)),), factor)

    def _as_part_of_longer(self, key: Components) -> Iterator[Route]:
        """Yield the lengths of vectors with three components, of which two are given."""
        if len(key) == 2 and all(len(component) == 1 for component in key):
            a, b = (component[0][1] for component in key)
            companions = self._relations.companions
            for other in sorted((companions[a] | companions[b]) - {a, b}):
                if other < len(self._sizes):
                    yield Route((_sorted(*key, ((1, other),)),))

    def _by_largest_terms(self, key: Components) -> Iterator[Route]:
        """Yield the length of the vector of the largest terms, plus that of all other terms."""
        opened = [self._opened(component) for component in key]
        if all(len(component) == 1 for component in opened):
            return
        largest = [max(component, key=self._size) for component in opened]
        pairs = zip(opened, largest, strict=True)
        rest = [tuple(term for term in component if term != most) for component, most in pairs]
        yield Route((_sorted(*((term,) for term in largest)), _sorted(*rest)))

    def _before_turns(self, key: Components) -> Iterator[Route]:
        """Yield the length of a vector before a turn, plus that of what is added after it."""
        opened = [self._opened(component) for component in key]
        for i, j in combinations(range(len(key)), 2):
            for first in self._relations.turns(opened[i]):
                for second in self._relations.turns(opened[j]):
                    if first.is_beside(second):
                        pair, rests = ((first.x,), (first.y,)), (first.others, second.others)
                        others = [k for k in range(len(key)) if k not in (i, j)]
                        if not others:
                            yield Route((_sorted(*pair), _sorted(*rests)))
                        for third in (form for k in others for form in {key[k], opened[k]}):
                            for term in third:
                                left = tuple(other for other in third if other != term)
                                yield Route((_sorted(*pair, (term,)), _sorted(*rests, left)))

    def _opened(self, component: Component) -> Component:
        """Return a component whose only term is taken apart."""
        if len(component) != 1:
            return component
        ((sign, number),) = component
        return self._relations.terms(number, sign)

    def _size(self, term: Term) -> float:
        """Return the largest magnitude of a term."""
        return self._sizes[term[1]]


class Lengths:
    """Bounds of lengths of vectors of exact values, over B boxes.

    Args:
        exact: Ranges of the exact values, to which the caller appends while they are found.
        routes: The routes to take.
    """

    def __init__(self, exact: Sequence[Intervals], routes: Routes) -> None:
        self._exact = exact
        self._routes = routes
        self._known: dict[Components, Floats] = {}

    def of_pair(self, a: int, b: int) -> Floats:
        """Return a bound (B,) of the length of the vector with the components a and b."""
        return self._length(_sorted(((1, a),), ((1, b),)))

    def _length(self, key: Components) -> Floats:
        """Return a bound of the length of a vector."""
        if key not in self._known:
            self._known[key] = self._by_magnitudes(key)
            route = self._routes.best(key, self._exact)
            if route is not None:
                self._known[key] = np.minimum(self._known[key], self._by_route(route))
        return self._known[key]

    def _by_route(self, route: Route) -> Floats:
        """Return the bound of a route."""
        total = up_sum([self._length(part) for part in route.parts])
        return total if route.factor is None else up_product(self._exact[route.factor].magnitude, total)

    def _by_magnitudes(self, key: Components) -> Floats:
        """Return the length of a vector whose components have their largest magnitudes."""
        sizes = [up_sum(self._exact[number].magnitude for _, number in component) for component in key]
        length: Floats = np.sqrt(sum((size * size for size in sizes), start=np.zeros(()))) * _SLACK
        return length


def _sorted(*components: Component) -> Components:
    """Return the components that are not empty, in an order that does not depend on theirs."""
    return tuple(sorted(component for component in components if component))
