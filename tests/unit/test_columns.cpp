// What column names mean, in the spellings of loggers.
#include <gtest/gtest.h>

#include "host_sim/recording/columns.hpp"
#include "host_sim/recording/spec.hpp"

using namespace fairlead::sim;

TEST(Columns, NamesOfLoggersAreUnderstood) {
    struct Known {
        const char* name;
        Role role;
        int axis;
        const char* unit;  // "": none
    };
    const Known all[] = {
        {"timestamp [ns]", Role::time, -1, "ns"},
        {"#timestamp ms", Role::time, -1, "ms"},
        {"Time (s)", Role::time, -1, "s"},
        {"seconds_elapsed", Role::time, -1, "s"},
        {"t", Role::time, -1, ""},
        {"nsec", Role::time_rest, -1, "ns"},
        {"w_RS_S_x [rad s^-1]", Role::gyro, 0, "rad/s"},
        {"omega_z", Role::gyro, 2, ""},
        {"Gyroscope y (rad/s)", Role::gyro, 1, "rad/s"},
        {"gx [deg/s]", Role::gyro, 0, "deg/s"},
        {"Gyroscope_x_DegPerS", Role::gyro, 0, "deg/s"},
        {"field.angular_velocity.x", Role::gyro, 0, ""},
        {"gyroRotationX(rad/s)", Role::gyro, 0, "rad/s"},
        {"a_RS_S_y [m s^-2]", Role::accel, 1, "m/s2"},
        {"alpha_z", Role::accel, 2, ""},
        {"acc_x_g", Role::accel, 0, "g"},
        {"gFx", Role::accel, 0, "g"},
        {"ACCELEROMETER X (m/s\u00b2)", Role::accel, 0, "m/s2"},
        {"Accel_LN_X_CAL", Role::accel, 0, ""},
        {"acc[0]", Role::accel, 0, ""},
        {"Magnetic field x (\u00b5T)", Role::mag, 0, "uT"},
        {"mx [uT]", Role::mag, 0, "uT"},
        {"mag_mG_x", Role::mag, 0, "mgauss"},
        {"mag_x_gauss", Role::mag, 0, "gauss"},
        {"p_RS_R_x [m]", Role::position, 0, "m"},
        {"tx", Role::position, 0, ""},
        {"p_x [mm]", Role::position, 0, "mm"},
        {"q_RS_w []", Role::quaternion, 0, ""},
        {"qx", Role::quaternion, 1, ""},
        {"pose.orientation.w", Role::quaternion, 0, ""},
        {"x (rad/s)", Role::gyro, 0, "rad/s"},
        {"x", Role::bare, 0, ""},
        {"temperature [degC]", Role::temperature, -1, "degC"},
        {"v_RS_R_x [m s^-1]", Role::ignored, 0, ""},
        {"b_w_RS_S_x [rad s^-1]", Role::ignored, 0, ""},
        {"num", Role::ignored, -1, ""},
        {"Pr11", Role::unknown, -1, ""},
        {"marker", Role::unknown, -1, ""},
    };
    for (const Known& k : all) {
        const Column c = column_of(k.name);
        EXPECT_EQ(to_string(c.role), std::string(to_string(k.role))) << k.name;
        if (k.axis >= 0 && k.role != Role::ignored) {
            EXPECT_EQ(c.axis, k.axis) << k.name;
        }
        EXPECT_EQ(c.unit ? c.unit->name : "", k.unit) << k.name;
    }
}

TEST(Columns, UnitsHaveTheirFactors) {
    EXPECT_DOUBLE_EQ(unit_of(Quantity::gyro, "\u00b0/s")->factor, 0.017453292519943295);
    EXPECT_DOUBLE_EQ(unit_of(Quantity::accel, "mg")->factor, 9.80665e-3);
    EXPECT_DOUBLE_EQ(unit_of(Quantity::mag, "mG")->factor, 0.1);
    EXPECT_DOUBLE_EQ(unit_of(Quantity::mag, "Gauss")->factor, 100);
    EXPECT_EQ(unit_of(Quantity::time, "1e-4")->time_shift, 5);
    EXPECT_FALSE(unit_of(Quantity::time, "0.0002").has_value()) << "no power of ten";
    EXPECT_DOUBLE_EQ(unit_of(Quantity::gyro, "0.00107")->factor, 0.00107);
    EXPECT_FALSE(unit_of(Quantity::gyro, "-1").has_value());
    EXPECT_FALSE(unit_of(Quantity::accel, "nan").has_value());
    EXPECT_EQ(column_of("ax [foo]").unknown_unit, "foo");
    EXPECT_EQ(column_of("gyro_x_raw").unknown_unit, "raw counts");
}

TEST(Columns, TheOptionRefusesWhatItDoesNotKnow) {
    EXPECT_EQ(parse_columns("t_ns,-,gx,ay[g]").size(), 4u);
    for (const char* bad : {"t_ns,foo", "t_ns,x", "t_ns,q0", "t_ns,ax[foo]"})
        EXPECT_THROW(parse_columns(bad), BadSpec) << bad;
    for (const char* name : {"t_us", "gx", "ay", "mz", "px", "qw", "qz", "temperature", "nsec"})
        EXPECT_EQ(short_name(parse_columns(name)[0]), name);
}
