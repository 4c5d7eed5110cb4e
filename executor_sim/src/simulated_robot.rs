//! Robot and world as one executor.

use std::collections::VecDeque;
use std::convert::Infallible;

use agent_core::model::{Action, Domain, ExecutionModel, FactChange, Symbol, Time};
use agent_core::protocol::{
    ActionId, Durable, Input, Machine, Output, Reply, Row, Rows, Unreadable,
};

use crate::{Controller, Faults, Floor, MotorCommand, MoverSpec, Place, Sensor, SetupError, World};

/// A [`Controller`] wired to a [`World`]: what one says, the other hears at once.
///
/// To agents it is an executor like any other, so whole stacks run in virtual time with it.
/// [`Input::Observation`] goes to the world: `(not (open d))` shuts the door `d`.
#[derive(Clone, Debug)]
pub struct SimulatedRobot {
    world: World,
    controller: Controller,
    outputs: VecDeque<Output<Infallible>>,
}

impl SimulatedRobot {
    /// A robot that stands at `start` in a world of its own.
    pub fn new(
        domain: &Domain,
        model: &ExecutionModel,
        floor: Floor,
        spec: MoverSpec,
        start: Place,
        faults: Faults,
    ) -> Result<Self, SetupError> {
        let mut robot = Self {
            controller: Controller::new(domain, model, floor.clone(), faults)?,
            world: World::new(floor, spec, start)?,
            outputs: VecDeque::new(),
        };
        // The controller's first command, and what it learns by it.
        robot.pump(Time::ZERO);
        Ok(robot)
    }

    /// The reality, for displays and for tests that know better than the robot.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// What superiors talk to.
    pub fn controller(&self) -> &Controller {
        &self.controller
    }

    /// See [`Controller::announcement`].
    pub fn announcement(&mut self) -> Vec<FactChange> {
        self.controller.announcement()
    }

    /// The controller's process dies and starts anew; the world goes on. It remembers nothing, and
    /// what it had not yet sent is lost.
    ///
    /// `fresh` is the controller of the new process.
    pub fn restart_controller(&mut self, now: Time, fresh: Controller) {
        self.controller = fresh;
        self.pump(now);
    }

    /// How the body drives from now on. What it is doing it goes on doing as before.
    pub(crate) fn set_spec(&mut self, spec: MoverSpec) {
        self.world.set_spec(spec);
    }

    /// What the robot's body is, written down: the controller is apart.
    pub(crate) fn write_down_world(&mut self) -> Vec<Row> {
        self.world.write_down()
    }

    /// To be called before what the controller has written down is recalled.
    pub(crate) fn recall_world(&mut self, rows: &Rows) -> Result<(), Unreadable> {
        self.world.recall(rows)?;
        // Where it stands is what the controller asks first.
        while self.world.poll_output().is_some() {}
        Ok(())
    }

    /// What goes wrong from now on.
    pub(crate) fn set_faults(&mut self, faults: Faults) {
        self.controller.set_faults(faults);
    }

    /// What it does, and whether it is stopping.
    pub(crate) fn doing(&self) -> Option<(&Action, bool)> {
        self.controller.doing()
    }

    /// How many suspended actions it keeps.
    pub(crate) fn depth(&self) -> usize {
        self.controller.depth()
    }

    /// Whether it has heard of that execution, and not forgotten it.
    pub(crate) fn knows(&self, id: &ActionId) -> bool {
        self.controller.knows(id)
    }

    /// Whether that is suspended.
    pub(crate) fn is_suspended(&self, superior: &Symbol, id: &ActionId) -> bool {
        Durable::is_suspended(&self.controller, superior, id)
    }

    /// Carries commands down and sensors up until nobody has anything to say.
    fn pump(&mut self, now: Time) {
        loop {
            let mut silent = true;
            while let Some(output) = self.controller.poll_output() {
                silent = false;
                match output {
                    Output::Local(command) => self.tell_world(now, command),
                    Output::Instruct { to, instruction } => {
                        self.outputs.push_back(Output::Instruct { to, instruction });
                    }
                    Output::Report { to, id, report } => {
                        self.outputs.push_back(Output::Report { to, id, report });
                    }
                    Output::Observed { facts, reported_to } => {
                        self.outputs
                            .push_back(Output::Observed { facts, reported_to });
                    }
                    // The robot of one superior keeps nothing from others.
                    Output::Seen { .. } => {}
                    Output::Event(event) => self.outputs.push_back(Output::Event(event)),
                }
            }
            while let Some(output) = self.world.poll_output() {
                silent = false;
                if let Output::Local(sensor) = output {
                    self.tell_controller(now, sensor);
                }
            }
            if silent {
                return;
            }
        }
    }

    fn tell_world(&mut self, now: Time, command: MotorCommand) {
        // Motors do not reply; they have sensors.
        let _ = self.world.handle(now, Input::Local(command));
    }

    fn tell_controller(&mut self, now: Time, sensor: Sensor) {
        // Nor does a controller reply to its sensors.
        let _ = self.controller.handle(now, Input::Local(sensor));
    }
}

/// The controller is written down. The world is what it is, whether or not anybody remembers it.
impl Durable for SimulatedRobot {
    fn write_down(&mut self) -> Vec<Row> {
        self.controller.write_down()
    }

    fn recall(&mut self, rows: &Rows) -> Result<(), Unreadable> {
        self.controller.recall(rows)?;
        self.pump(self.world.time());
        Ok(())
    }
}

impl Machine for SimulatedRobot {
    type In = Infallible;
    type Out = Infallible;

    fn handle(&mut self, now: Time, input: Input<Infallible>) -> Option<Reply> {
        // What was due has happened before anybody speaks: an instruction that comes at the
        // moment of arrival finds the robot arrived.
        let _ = self.world.handle(now, Input::Wake);
        self.pump(now);
        let reply = match input {
            Input::Observation(changes) => self.world.handle(now, Input::Observation(changes)),
            Input::Goal(goal) => self.controller.handle(now, Input::Goal(goal)),
            Input::Command(command) => self.controller.handle(now, Input::Command(command)),
            Input::Instruction { from, instruction } => self
                .controller
                .handle(now, Input::Instruction { from, instruction }),
            Input::Answer { to, answer } => {
                self.controller.handle(now, Input::Answer { to, answer })
            }
            Input::Report { id, report } => {
                self.controller.handle(now, Input::Report { id, report })
            }
            Input::Neighbour { name, there } => self
                .controller
                .handle(now, Input::Neighbour { name, there }),
            Input::Reborn { name } => self.controller.handle(now, Input::Reborn { name }),
            Input::Wake => self.controller.handle(now, Input::Wake),
            Input::Local(never) => match never {},
        };
        self.pump(now);
        reply
    }

    fn poll_output(&mut self) -> Option<Output<Infallible>> {
        self.outputs.pop_front()
    }

    fn wake_at(&self) -> Option<Time> {
        [self.world.wake_at(), self.controller.wake_at()]
            .into_iter()
            .flatten()
            .min()
    }

    fn wind_down(&mut self, now: Time) {
        self.controller.wind_down(now);
        self.pump(now);
    }

    fn rests(&self) -> bool {
        self.controller.rests()
    }
}
