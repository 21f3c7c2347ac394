"""The computation of the module, on objects of VTK alone."""
