"""The demonstration of gimbal lock: one motion in angle rates, in angular velocity and with a quaternion."""
