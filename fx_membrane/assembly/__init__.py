"""From a structure to energy, residual and tangent: meshes, compiled forms, actions, the problem."""
