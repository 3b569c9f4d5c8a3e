// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Docstrings of what is compiled: they are written once, in __init__.pyi.
#include <cstdlib>
#include <cstring>

#include "bindings.hpp"

namespace edged::python {
namespace {

/// Below the signature, which pybind11 has made and frees with std::free.
void append_doc(const py::handle& function, const std::string& text) {
  PyObject* inner = function.ptr();
  if (PyInstanceMethod_Check(inner)) inner = PyInstanceMethod_GET_FUNCTION(inner);
  if (!PyCFunction_Check(inner)) throw py::type_error("is no compiled function");
  PyMethodDef* const method = reinterpret_cast<PyCFunctionObject*>(inner)->m_ml;
  const std::string doc = (method->ml_doc ? method->ml_doc : "") + ("\n" + text);
  std::free(const_cast<char*>(method->ml_doc));
  method->ml_doc = strdup(doc.c_str());
}

}  // namespace

void bind_docs(py::module_& module) { module.def("append_doc", &append_doc); }

}  // namespace edged::python
