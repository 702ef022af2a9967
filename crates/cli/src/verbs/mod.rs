//! One file per verb.

mod calibrate;
mod compare;
mod demo;
mod eval;
mod load;
mod mine;
mod nlos;
mod recorded_set;
mod replay;
mod serve;
mod simulate;
mod store;
mod track;
mod trials;
mod tune;

use crate::args::Verb;
use anyhow::Result;

/// Does what was asked for.
pub fn run(verb: &Verb) -> Result<()> {
    match verb {
        Verb::Demo(args) => demo::run(args),
        Verb::Simulate(args) => simulate::run(args),
        Verb::Track(args) => track::run(args),
        Verb::Eval(args) => eval::run(args),
        Verb::Calibrate(args) => calibrate::run(args),
        Verb::Mine(args) => mine::run(args),
        Verb::Nlos(args) => nlos::run(args),
        Verb::Compare(args) => compare::run(args),
        Verb::Tune(args) => tune::run(args),
        Verb::Load(args) => load::run(args),
        Verb::Replay(args) => replay::run(args),
        Verb::Serve(args) => serve::run(args),
        Verb::Store(args) => store::store(args),
        Verb::Audit(args) => store::audit(args),
    }
}
