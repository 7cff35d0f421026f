//! Rounds in which all libraries run in turn. The speed of a machine drifts, but little within a round: so
//! libraries are compared within each round.

use crate::inputs::Inputs;
use crate::libraries::{self, Answer, Library, NAMES, Task};
use rustix::time::{ClockId, clock_gettime};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// A library whose first build takes so many times as long as ours has no other round.
const SLOW: f64 = 20.0;

/// Targets of linear interpolation, which is compared and not measured.
const LINEAR_TARGETS: usize = 100_000;

/// What is known of a library.
#[derive(Default)]
pub struct Measured {
    /// Seconds by task and round; none of tasks that it does not have.
    pub seconds: [Vec<f64>; Task::ALL.len()],
    /// Answers by task.
    pub answers: [Option<Answer>; Task::ALL.len()],
    /// Values of linear interpolation at the first random targets.
    pub linear: Option<Vec<f64>>,
    /// The task that panicked. None is tried after it.
    pub failure: Option<Task>,
    /// Whether it ran once only.
    pub is_slow: bool,
}

/// Measures all libraries, by number. Each round begins with another library, the first with ours.
pub fn measure(inputs: &Inputs, rounds: usize) -> Vec<Measured> {
    let mut all: Vec<Measured> = NAMES.iter().map(|_| Measured::default()).collect();
    for round in 0..rounds {
        for number in (0..NAMES.len()).map(|turn| (turn + round) % NAMES.len()) {
            if all[number].is_slow || inputs.points.len() > libraries::points_max(number) {
                continue;
            }
            eprintln!("{} {}, round {round}: {}", inputs.kind.name(), inputs.points.len(), NAMES[number]);
            run(number, inputs, &mut all[number]);
            let build = |measured: &Measured| measured.seconds[0].first().copied();
            all[number].is_slow = build(&all[number]) > build(&all[0]).map(|ours| SLOW * ours);
        }
    }
    all
}

/// One round of a library.
fn run(number: usize, inputs: &Inputs, measured: &mut Measured) {
    let mut library: Option<Box<dyn Library>> = None;
    for (place, task) in Task::ALL.into_iter().enumerate() {
        let done = catch_unwind(AssertUnwindSafe(|| {
            timed(|| match &mut library {
                None => {
                    let built = library.insert(libraries::build(number, &inputs.points));
                    Some(Answer::Count(built.triangles()))
                }
                Some(library) => task.run(library.as_mut(), inputs),
            })
        }));
        match done {
            Err(_) => {
                measured.failure = Some(task);
                return;
            }
            Ok((Some(answer), seconds)) => {
                measured.seconds[place].push(seconds);
                measured.answers[place] = Some(answer);
            }
            Ok((None, _)) => {}
        }
        if task == Task::Build && measured.linear.is_none() {
            measured.linear =
                library.as_mut().and_then(|built| built.linear(&inputs.random[..LINEAR_TARGETS]));
        }
    }
}

/// The result of `work`, and the processor time of all threads meanwhile in seconds.
fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = processor_time();
    let result = work();
    (result, processor_time() - start)
}

fn processor_time() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}
