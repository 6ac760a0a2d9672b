"""A FreeCAD job: a block pressed on a plate, drawn, meshed by Gmsh, solved by the program of JOB_PROGRAM in place of ccx, read back.

    JOB_FOLDER=. JOB_PROGRAM=/usr/local/bin/amontons-ccx freecadcmd freecad_job.py

The two faces must not lie in one plane, else FreeCAD gives the nodes of both bodies to both faces: there is a gap of 0.01 mm.

SPDX-License-Identifier: GPL-3.0-or-later
"""

import json
import os
from pathlib import Path

import FreeCAD as App
import ObjectsFem
from femmesh import gmshtools
from femtools import ccxtools

GAP = 0.01
folder = Path(os.environ["JOB_FOLDER"])
preferences = App.ParamGet("User parameter:BaseApp/Preferences/Mod/Fem/Ccx")
preferences.SetBool("UseStandardCcxLocation", False)
preferences.SetString("ccxBinaryPath", os.environ["JOB_PROGRAM"])

doc = App.newDocument("press")
plate, block = doc.addObject("Part::Box", "Plate"), doc.addObject("Part::Box", "Block")
plate.Length, plate.Width, plate.Height = 40, 40, 10
block.Length, block.Width, block.Height = 20, 20, 15
block.Placement.Base = App.Vector(10, 10, 10 + GAP)
both = doc.addObject("Part::Compound", "Both")
both.Links = [plate, block]
doc.recompute()


def face(z):
    """The horizontal face at a height."""
    (found,) = [f"Face{i + 1}" for i, one in enumerate(both.Shape.Faces) if max(abs(one.BoundBox.ZMin - z), abs(one.BoundBox.ZMax - z)) < 1e-6]
    return (both, found)


analysis = ObjectsFem.makeAnalysis(doc, "Analysis")
solver = ObjectsFem.makeSolverCalculixCcxTools(doc, "Solver")
steel = ObjectsFem.makeMaterialSolid(doc, "Steel")
steel.Material = steel.Material | {"Name": "Steel", "YoungsModulus": "210000 MPa", "PoissonRatio": "0.3"}
fixed = ObjectsFem.makeConstraintFixed(doc, "Fixed")
fixed.References = [face(0)]
pressed = ObjectsFem.makeConstraintDisplacement(doc, "Pressed")
pressed.References = [face(25 + GAP)]
pressed.xFree = pressed.yFree = pressed.zFree = False
pressed.xFix = pressed.yFix = True
pressed.zDisplacement = -0.02 - GAP
touch = ObjectsFem.makeConstraintContact(doc, "Touch")
touch.References = [face(10 + GAP), face(10)]
touch.Slope, touch.Friction = 2.1e6, 0.2
mesh = ObjectsFem.makeMeshGmsh(doc, "Mesh")
mesh.Part, mesh.CharacteristicLengthMax, mesh.ElementOrder = both, 10.0, "2nd"
doc.recompute()
gmshtools.GmshTools(mesh).create_mesh()
for one in (solver, steel, fixed, pressed, touch, mesh):
    analysis.addObject(one)
doc.recompute()

job = ccxtools.FemToolsCcx(analysis, solver)
job.update_objects()
job.setup_working_dir(str(folder))
missing = job.check_prerequisites()
job.write_inp_file()
code = job.ccx_run()
report = {"missing": missing, "code": code, "stderr": job.ccx_stderr, "deck": job.inp_file_name}
if code == 0:
    job.load_results()
    (result,) = [one for one in analysis.Group if one.isDerivedFrom("Fem::FemResultObject")]
    report |= {"nodes": list(result.NodeNumbers), "U": [list(v) for v in result.DisplacementVectors], "mises": list(result.vonMises)}
(folder / "report.json").write_text(json.dumps(report))
