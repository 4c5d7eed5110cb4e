//! A planner for whole problems: from a domain and a problem in HDDL to a plan.
