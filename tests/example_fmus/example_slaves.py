"""Slaves of the examples without a host: by their names, with values by name."""

from tetherfmu.libraries.examples import example

example_fmus = example("shared.example_fmus")


class Model:
    """A slave of the examples; values are set and read by name, a vector as three numbers.

    file : of turbulent wind.
    """

    def __init__(self, name, file="", **values):
        self.slave = example_fmus.slave(name)(instance_name=name, resources="")
        self.places = {each.name: each.place for each in self.slave.table}
        self.messages, self.time = [], 0.0
        self.slave.say = lambda message, level: self.messages.append(message)
        self.set(**values)
        self.slave.file = str(file)
        self.slave.enter_initialization_mode()
        self.slave.exit_initialization_mode()

    def set(self, **values):
        for name, value in values.items():
            names = [name] if name in self.places else [f"{name}[{i}]" for i in (1, 2, 3)]
            for each, number in zip(names, [value] if name in self.places else value, strict=True):
                self.slave.values[self.places[each]] = number

    def get(self, name):
        if name in self.places:
            return self.slave.values[self.places[name]]
        return [self.slave.values[self.places[f"{name}[{i}]"]] for i in (1, 2, 3)]

    def step(self, step, **values):
        """Whether the step was done."""
        self.set(**values)
        done = self.slave.do_step(self.time, step)
        self.time += step if done else 0.0
        return done
