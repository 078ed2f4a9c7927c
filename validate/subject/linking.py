"""Machine code where it is asked for: a compiled function that only other compiled functions call gets none of its own.

numba links each function into all that call it, and yet optimises each on its own and turns each into machine code.
A loop that is made of parts has a hundred functions, of which Python calls one, and ten are called by their addresses.
Without the machine code of the others it compiles in half to four fifths of the time, and its steps are as fast.

Importing this module imports numba.
"""

import ctypes
from contextlib import suppress

from numba.core.codegen import CPUCodeLibrary, JITCodeLibrary, JITCPUCodegen, RuntimeLinker, ll
from numba.core.cpu import CPUTargetOptions
from numba.core.environment import lookup_environment
from numba.core.options import TargetOptions

ENVIRONMENT = "_ZN08NumbaEnv"            # begins the names in machine code of where a function finds Python's objects
FOR_PYTHON = "_ZN7cpython"               # begins the names of what Python calls
CALLED_BY_NAME = {"nrt", "multi3"}       # numba's own libraries whose functions are called by their names
REFUSE = ctypes.cast(ctypes.pythonapi.PyErr_BadArgument, ctypes.c_void_p).value    # raises a TypeError
LINKED = "linked"                        # kind of what is saved without machine code
SIDE_BY_SIDE: set[str] = set()           # names of functions that compute with several numbers at once


class LinkedLibrary(JITCodeLibrary):
    """The code of a function, which becomes machine code when its address is first asked for.

    Libraries that call it have linked it in before.
    """

    is_ready = False                     # whether the machine code can be called
    _compiled_object = None              # the machine code, to be saved, or loaded and not yet called

    def _optimize_final_module(self):
        """Leave it to _make_machine_code: what calls this function optimises its own copy.

        Only what computes with several numbers at once is optimised here: first what it calls becomes part of it, and
        then its loop becomes vector instructions.
        """
        if self.name in SIDE_BY_SIDE:
            for vectorize in (False, True):
                passes, builder = self.codegen._module_pass_manager(loop_vectorize=vectorize)
                passes.run(self._final_module, builder)

    def _finalize_final_module(self):
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True
        if any(one.name.startswith(RuntimeLinker.PREFIX) for one in self._final_module.global_variables):
            self._make_machine_code()                                    # it calls itself, by its address

    def _make_machine_code(self):
        self.is_ready = True
        self._get_module_for_linking()                                   # others link it as it is now
        CPUCodeLibrary._optimize_final_module(self)
        CPUCodeLibrary._finalize_final_module(self)
        for one in self._final_module.global_variables:
            if one.name.startswith(ENVIRONMENT) and (environment := lookup_environment(one.name)):
                self.codegen.set_env(one.name, environment)

    def get_pointer_to_function(self, name):
        """Return the address of a function, or 0 where this library has none of that name.

        What Python calls may not have been compiled.  A call from Python then raises a TypeError.
        """
        self._ensure_finalized()
        with suppress(NameError):
            if not (self._shared_module or self._final_module).get_function(name).is_declaration:
                if not self.is_ready:
                    self._make_machine_code()
                return super().get_pointer_to_function(name)
        return REFUSE if name.startswith(FOR_PYTHON) else 0

    def serialize_using_object_code(self):
        if self._compiled_object is not None:
            return super().serialize_using_object_code()
        return self.name, LINKED, self._final_module.as_bitcode()

    @classmethod
    def _unserialize(cls, codegen, state):
        name, kind, data = state
        if kind != LINKED:
            return super()._unserialize(codegen, state)
        self = codegen.create_library(name)
        self.enable_object_caching()
        self._final_module = ll.parse_bitcode(data)
        self._finalize_final_module()
        return self


def is_linked_only(library):
    """Return whether a library has no machine code, and saves none."""
    return isinstance(library, LinkedLibrary) and not library.is_ready and library._compiled_object is None


def create_library(codegen, name):
    """Create the library of a function that is to be compiled."""
    return (JITCodeLibrary if name in CALLED_BY_NAME else LinkedLibrary)(codegen, name)


def set_env(codegen, name, environment, usual=JITCPUCodegen.set_env):
    """Tell machine code where to find Python's objects, if there is machine code of that name."""
    if codegen._engine.get_global_value_address(name):
        usual(codegen, name, environment)


def link_only():
    """Let numba make machine code only of functions whose address is asked for."""
    JITCPUCodegen._library_class = LinkedLibrary
    CPUTargetOptions.noalias = TargetOptions.Mapping("noalias")          # LLVM may know that arrays share no memory
    JITCPUCodegen.create_library, JITCPUCodegen.set_env = create_library, set_env
