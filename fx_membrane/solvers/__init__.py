"""From a problem and a start to a solution: Newton's method, first-order methods, eigenvalues, diagnosis."""
