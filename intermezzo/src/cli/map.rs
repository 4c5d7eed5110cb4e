//! What can be typed about maps.

use std::path::PathBuf;

use clap::{Args, Subcommand};

#[derive(Debug, Subcommand)]
pub(crate) enum MapCommand {
    /// Name everything that is wrong with a map, each with its line.
    Check {
        /// A map in the shape of Nav2's Route Server.
        file: PathBuf,
    },
    /// Make up a museum of any size, to see how things go on a map as large as yours.
    Scale(ScaleArgs),
    /// Make a map of a navigation graph of Open-RMF.
    FromRmf(FromRmfArgs),
    /// Draw a map: areas, nodes, passages and doors, and the shortest way between two nodes.
    Svg(SvgArgs),
}

#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Examples:
  intermezzo map from-rmf maps/examples/office.rmf.yaml -o office/      a whole place, then:
  intermezzo up office --start charger1
  intermezzo map from-rmf 0.yaml --level L2 --areas-by names -o l2.geojson

A navigation graph has no areas; ours are made so: what can be reached without passing a door is an area,
and what is too large then, or has a door inside, is cut in two. Where areas meet without a door, a gate is
made up that is open. What is left out or made up is told on the standard error. See maps/README.md.

Exit status: 0 made; 1 the graph has faults, each is named with its line; 2 no such file, or OUT cannot be
written.")]
pub(crate) struct FromRmfArgs {
    /// A navigation graph in YAML, as building_map_generator of rmf_building_map_tools makes it.
    pub(crate) file: PathBuf,
    /// The file to write the map to, or a folder (it exists, or its name ends in `/`) to write a whole
    /// place to, with the museum's domains. Without it the map is printed.
    #[arg(short, long, value_name = "OUT")]
    pub(crate) output: Option<PathBuf>,
    /// The level that is wanted, if there are several.
    #[arg(long, value_name = "NAME")]
    pub(crate) level: Option<String>,
    /// What makes an area: only doors, or also what vertices are called (a property `area`, or else what
    /// names have in common: office_101 and office_102).
    #[arg(long, value_enum, default_value_t = AreasBy::Doors)]
    pub(crate) areas_by: AreasBy,
    /// An area of more nodes is cut.
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(2..))]
    pub(crate) area_nodes: u32,
    /// Print one JSON object with what was made, left out and made up.
    #[arg(long, requires = "output")]
    pub(crate) json: bool,
}

/// What makes an area.
#[derive(Clone, Copy, Debug, Eq, PartialEq, clap::ValueEnum)]
pub(crate) enum AreasBy {
    Doors,
    Names,
}

#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Examples:
  intermezzo map svg maps/museum/map.geojson -o museum.svg
  intermezzo map svg maps/museum/map.geojson --start n1 --route n1 n40 --closed door3_5 > museum.svg

The picture is the same whenever the map is. Labels for which there is no room are left out; in a map of
up to 2,000 nodes each node, door and area says what it is where the pointer rests on it.

Exit status: 0 drawn; 1 the map has faults, or there is no way; 2 no such file, node or door, or OUT cannot
be written.")]
pub(crate) struct SvgArgs {
    /// A map in the shape of Nav2's Route Server.
    pub(crate) file: PathBuf,
    /// The file to write the picture to. Without it the picture is printed.
    #[arg(short, long, value_name = "OUT")]
    pub(crate) output: Option<PathBuf>,
    /// Draw this door closed. May be given several times.
    #[arg(long, value_name = "DOOR")]
    pub(crate) closed: Vec<String>,
    /// Draw this door open, though the map has it closed at first.
    #[arg(long, value_name = "DOOR")]
    pub(crate) open: Vec<String>,
    /// Mark the node where the robot starts.
    #[arg(long, value_name = "NODE")]
    pub(crate) start: Option<String>,
    /// Show the shortest way from node to node, through the doors that are drawn open.
    #[arg(long, num_args = 2, value_names = ["FROM", "TO"])]
    pub(crate) route: Vec<String>,
}

#[derive(Args, Clone, Debug)]
pub(crate) struct ScaleArgs {
    /// How many nodes it is to have. There is an area for every five of them.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(maps::MOST_NODES)))]
    pub(crate) nodes: u32,
    /// The same seed makes the same museum.
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,
    /// The file to write the map to, or a folder (it exists, or its name ends in `/`) to write a whole
    /// place to, with the museum's domains. Without it the map is printed.
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
}
