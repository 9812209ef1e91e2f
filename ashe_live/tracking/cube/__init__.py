"""The paper cube that is marker, caster and light probe in one: its faces, and the sheet that it is folded from."""
