//! Functions of dynibo for the driver in C. The model is a URDF file in which every joint has one freedom.
use dynibo::Robot;
use std::ffi::{CStr, c_char, c_int};
use std::slice::{from_raw_parts, from_raw_parts_mut};

/// A robot, and accelerations that are zero.
pub struct Peer {
    robot: Robot,
    rest: Vec<f64>,
}

/// Read a file; null if it cannot be read.
///
/// # Safety
/// `path` ends in a zero.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn peer_open(path: *const c_char) -> *mut Peer {
    let path = unsafe { CStr::from_ptr(path) }.to_string_lossy().into_owned();
    match Robot::from_urdf(path) {
        Ok(robot) => {
            let rest = vec![0.0; robot.generalized_count()];
            Box::into_raw(Box::new(Peer { robot, rest }))
        }
        Err(error) => {
            eprintln!("{error}");
            std::ptr::null_mut()
        }
    }
}

/// Return the name of a joint, which is a number.
///
/// # Safety
/// `peer` is from `peer_open`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn peer_joint(peer: *const Peer, index: usize) -> c_int {
    let robot = unsafe { &(*peer).robot };
    robot.joint_name(index).ok().and_then(|name| name.parse().ok()).unwrap_or(-1)
}

/// Compute the mass matrix and the forces that no acceleration requires; returns 0 if that is possible.
///
/// # Safety
/// `peer` is from `peer_open`; the arrays have `n`, and the mass matrix `n` times `n` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn peer_equations(
    peer: *mut Peer,
    n: usize,
    q: *const f64,
    v: *const f64,
    mass: *mut f64,
    bias: *mut f64,
) -> c_int {
    let (peer, q, v) = unsafe { (&mut *peer, from_raw_parts(q, n), from_raw_parts(v, n)) };
    let (mass, bias) = unsafe { (from_raw_parts_mut(mass, n * n), from_raw_parts_mut(bias, n)) };
    let done = peer.robot.mass_matrix(q, mass);
    let also = peer.robot.inverse_dynamics(q, v, &peer.rest, &[], bias);
    c_int::from(done.is_err() || also.is_err())
}

/// Compute accelerations; returns 0 if that is possible.
///
/// # Safety
/// `peer` is from `peer_open`; the arrays have `n` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn peer_dynamics(
    peer: *mut Peer,
    n: usize,
    q: *const f64,
    v: *const f64,
    tau: *const f64,
    acceleration: *mut f64,
) -> c_int {
    let (peer, q, v) = unsafe { (&mut *peer, from_raw_parts(q, n), from_raw_parts(v, n)) };
    let (tau, out) = unsafe { (from_raw_parts(tau, n), from_raw_parts_mut(acceleration, n)) };
    c_int::from(peer.robot.forward_dynamics(q, v, tau, &[], out).is_err())
}
