//! How much users may ask for, as it is typed.

use std::fmt;
use std::str::FromStr;

use clap::Args;

use crate::quota::{Limits, Rate};

/// How much users may ask for. What is beyond is rejected, and whoever asked is told.
#[derive(Args, Clone, Copy, Debug)]
pub struct LimitOptions {
    /// How many goals may wait, be suspended or be set aside; emergencies and others are counted
    /// apart.
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = at_least_one)]
    pub most_waiting: usize,
    /// How many emergencies one sender may ask for in a second, in the long run; what falls due in
    /// five seconds may be asked for at once.
    #[arg(long, value_name = "X", default_value_t = RateOption(Limits::default().of_sender))]
    pub emergencies_per_second: RateOption,
    /// The same, for all senders together.
    #[arg(long, value_name = "X", default_value_t = RateOption(Limits::default().in_total))]
    pub emergencies_in_total: RateOption,
}

impl LimitOptions {
    /// For the wiring.
    pub fn limits(&self) -> Limits {
        Limits {
            of_sender: self.emergencies_per_second.0,
            in_total: self.emergencies_in_total.0,
        }
    }

    /// As they are typed, to hand them on to another process.
    pub fn to_args(&self) -> Vec<String> {
        [
            "--most-waiting",
            &self.most_waiting.to_string(),
            "--emergencies-per-second",
            &self.emergencies_per_second.to_string(),
            "--emergencies-in-total",
            &self.emergencies_in_total.to_string(),
        ]
        .map(str::to_owned)
        .into()
    }
}

impl Default for LimitOptions {
    fn default() -> Self {
        let Limits {
            of_sender,
            in_total,
        } = Limits::default();
        Self {
            most_waiting: 64,
            emergencies_per_second: RateOption(of_sender),
            emergencies_in_total: RateOption(in_total),
        }
    }
}

/// [`Rate`] as it is typed: a number above zero, of times in a second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateOption(pub Rate);

impl FromStr for RateOption {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let rate = text.parse().ok().and_then(Rate::per_second);
        rate.map(Self)
            .ok_or_else(|| "expected a number above zero, such as 5 or 0.5".to_owned())
    }
}

impl fmt::Display for RateOption {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.0.number())
    }
}

fn at_least_one(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(number) if number > 0 => Ok(number),
        _ => Err("expected a number of at least 1".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use agent_core::agent::Policy;
    use clap::Parser;

    #[derive(Debug, Parser)]
    struct Typed {
        #[command(flatten)]
        limits: LimitOptions,
    }

    fn typed(args: &[&str]) -> Result<LimitOptions, clap::Error> {
        let args = ["test"].iter().chain(args);
        Ok(Typed::try_parse_from(args)?.limits)
    }

    #[test]
    fn limits_reach_another_process_as_they_were_typed() {
        let args = ["--most-waiting", "3", "--emergencies-per-second", "0.5"];
        let limits = typed(&args).unwrap();
        assert_eq!(limits.most_waiting, 3);
        assert_eq!(limits.limits().of_sender, Rate::per_second(0.5).unwrap());
        let args = limits.to_args();
        let args: Vec<&str> = args.iter().map(String::as_str).collect();
        assert_eq!(typed(&args).unwrap().to_args(), args);
    }

    #[test]
    fn unless_limits_are_typed_they_are_what_they_are_everywhere() {
        let limits = typed(&[]).unwrap();
        assert_eq!(limits.limits(), Limits::default());
        assert_eq!(limits.most_waiting, Policy::default().most_waiting);
        assert_eq!(limits.to_args(), LimitOptions::default().to_args());
        for wrong in ["0", "-1", "x"] {
            assert!(typed(&["--most-waiting", wrong]).is_err(), "{wrong}");
            assert!(
                typed(&["--emergencies-per-second", wrong]).is_err(),
                "{wrong}"
            );
        }
    }
}
