"""The physics of prestressed tension structures, as UFL functions of UFL operands.

One formula, one function; d = 2 is a membrane, d = 1 a cable or a mast, and the same functions serve both.
The reference configuration is the prestressed one, `X`; the displacement is `u`; the current position `x = X + u`.
Stresses are forces per length (d = 2, [N/m]) or forces (d = 1, [N]): the thickness or the cross-section is in them.
Equation numbers, `Gil (40)`, are those of A. J. Gil, Computers & Structures 84 (2006) 1012-1028.
"""
