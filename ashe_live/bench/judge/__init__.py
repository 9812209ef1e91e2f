"""Fits the tables of the judge to pictures with known lights, and shows how they carry over to families left out.

May import the benches' common modules, the estimators and what they judge by, and `bench.light`.
"""
