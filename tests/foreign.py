"""FMUs of another maker, for tests."""

import zipfile

import fmpy

DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="{fmi}" modelName="foreign" guid="{{0}}">
  <{kind} modelIdentifier="foreign"/>
  <ModelVariables>
    <ScalarVariable name="{output}" valueReference="0" causality="output" variability="continuous" initial="calculated">
      <Real{wrong}/>
    </ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs><Unknown index="1"/></Outputs><InitialUnknowns><Unknown index="1"/></InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>
"""


def foreign(path, fmi="2.0", wrong="", kind="CoSimulation", output="y"):
    """Write an FMU of another maker with a library for this platform, which is none; returns its path."""
    with zipfile.ZipFile(path, "w") as archive:
        description = DESCRIPTION.format(fmi=fmi, wrong=wrong, kind=kind, output=output)
        archive.writestr("modelDescription.xml", description)
        archive.writestr(f"binaries/{fmpy.platform}/foreign{fmpy.sharedLibraryExtension}", b"no library")
    return path
