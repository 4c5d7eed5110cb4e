//! What can be typed about certificates and passwords.

use std::path::PathBuf;

use clap::Args;

#[derive(Args, Clone, Debug)]
#[command(after_help = "\
In DIR there is then, each readable by you alone:
  ca.pem, ca-key.pem            an authority; its key makes more certificates, and nothing else needs it
  router, supervisor, parent, child, executor, world, operator, viewer, room, k1, k2, k3
                                of each a certificate, its private key and a zenoh configuration
k1 to k3 are the vehicles of the restaurant that is built in; with PLACE, it is those of that place.

Examples:
  intermezzo certs keys                          then: intermezzo up --security keys
  intermezzo certs keys my/restaurant            then: intermezzo up my/restaurant --security keys
  intermezzo certs keys --vehicle k4             one vehicle more, with the rules for it
  intermezzo certs keys --name robot1.example    if other machines reach the router by that name
  intermezzo certs keys --add anna               one user more, signed by the same authority

security/README.md says what each may do. Exit status: 0 all is there; 2 nothing was written.")]
pub(crate) struct CertsArgs {
    /// The folder; it is made if it is not there.
    #[arg(value_name = "DIR")]
    pub(crate) dir: PathBuf,
    /// The place, if it is a restaurant of one's own: each of its vehicles gets an identity.
    #[arg(value_name = "PLACE", conflicts_with_all = ["add", "vehicle"])]
    pub(crate) place: Option<PathBuf>,
    /// A name or address by which other machines reach the router. May be given several times.
    #[arg(long, value_name = "HOST", conflicts_with_all = ["add", "vehicle"])]
    pub(crate) name: Vec<String>,
    /// How long the certificates are good for; the authority is for ten years.
    #[arg(long, value_name = "DAYS", default_value_t = 365, value_parser = clap::value_parser!(u16).range(1..=3650))]
    pub(crate) days: u16,
    /// One user more, by an authority that was made here before.
    #[arg(long, value_name = "NAME")]
    pub(crate) add: Option<String>,
    /// One vehicle more for a team that was let in here before. May be given several times.
    #[arg(long, value_name = "NAME", conflicts_with = "add")]
    pub(crate) vehicle: Vec<String>,
    /// Replace what is there. Whoever has the old files is locked out.
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Args, Clone, Debug)]
#[command(after_help = "\
In DIR there is then, each readable by you alone:
  router.json5, credentials.txt       the router's configuration, and the names and passwords it knows
  supervisor, parent, child, executor, world, operator, viewer, room, k1, k2, k3 (.json5)
                                      of each a zenoh configuration with its name and password
k1 to k3 are the vehicles of the restaurant that is built in; with PLACE, it is those of that place.

Passwords are not sent, but what is said can be read on the way and changed: beyond one machine use
certificates (intermezzo certs).

Examples:
  intermezzo passwords keys                then: intermezzo up --security keys
  intermezzo passwords keys my/restaurant  then: intermezzo up my/restaurant --security keys
  intermezzo passwords keys --vehicle k4   one vehicle more, with the rules for it
  intermezzo passwords keys --add anna     one user more

security/README.md says what each may do. Exit status: 0 all is there; 2 nothing was written.")]
pub(crate) struct PasswordsArgs {
    /// The folder; it is made if it is not there.
    #[arg(value_name = "DIR")]
    pub(crate) dir: PathBuf,
    /// The place, if it is a restaurant of one's own: each of its vehicles gets an identity.
    #[arg(value_name = "PLACE", conflicts_with_all = ["add", "vehicle"])]
    pub(crate) place: Option<PathBuf>,
    /// One user more.
    #[arg(long, value_name = "NAME")]
    pub(crate) add: Option<String>,
    /// One vehicle more for a team that was let in here before. May be given several times.
    #[arg(long, value_name = "NAME", conflicts_with = "add")]
    pub(crate) vehicle: Vec<String>,
    /// Replace what is there. Whoever has the old files is locked out.
    #[arg(long)]
    pub(crate) force: bool,
}
