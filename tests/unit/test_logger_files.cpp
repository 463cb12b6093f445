// Files as well-known loggers, phones, autopilots and motion capture write them: preambles, names
// in two lines, several clocks, dates, angles beside quaternions. Each is read as it was meant, or
// refused with the option that settles it; with that option it is read.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "host_sim/recording/recording.hpp"

using namespace fairlead;
using namespace fairlead::sim;

namespace {

constexpr int records = 300;
constexpr double step_s = 0.01, g = 9.80665, to_deg = 57.29577951308232;

/// The numbers of record i by their names, as the rows of the loggers below use them.
std::map<std::string, std::string> values_of(int i) {
    const double t = i * step_s, a = 0.8 * std::sin(1.5 * t), w = 1.2 * std::cos(1.5 * t);
    std::map<std::string, std::string> out;
    const auto put = [&](const std::string& name, double value, const char* form = "%.9g") {
        char text[48];
        std::snprintf(text, sizeof text, form, value);
        out[name] = text;
    };
    const double gyro[] = {w, 0.1, -0.02}, accel[] = {0, g * std::sin(a), g * std::cos(a)};
    const double mag[] = {20, -40 * std::sin(a), -40 * std::cos(a)};
    const double p[] = {0.3 * std::sin(t), 0.1 * t, 1}, free[] = {0.01, 0.02 * std::sin(t), 0};
    for (int k = 0; k < 3; ++k) {
        const std::string axis(1, "xyz"[k]);
        put("g" + axis, gyro[k]), put("dps" + axis, gyro[k] * to_deg);
        put("a" + axis, accel[k]), put("G" + axis, accel[k] / g);
        put("m" + axis, mag[k]), put("p" + axis, p[k]), put("mm" + axis, 1000 * p[k]);
        put("free" + axis, free[k]);
    }
    put("qw", std::cos(a / 2)), put("qx", 0.8 * std::sin(a / 2)), put("qy", 0.6 * std::sin(a / 2));
    put("qz", 0), put("i", i, "%.0f"), put("s", t, "%.6f"), put("ms", 10.0 * i, "%.0f");
    put("us", 1e6 + 1e4 * i, "%.0f"), put("ns", 5e9 + 1e7 * i, "%.0f"),
        put("sec", 100 + i / 100, "%.0f");
    put("nsec", i % 100 * 1e7, "%.0f"), put("clock", t, "12:34:%06.3f"),
        put("ticks", 45000.0 * i, "%.0f");
    put("late", 6e9 + 1e7 * i + i * i % 7 * 1e4, "%.0f");
    out["e"] = out["s"] + "E0";
    return out;
}

/// "{gx},{gy}": each name in braces gives way to its number.
std::string filled(const std::string& row, const std::map<std::string, std::string>& values) {
    std::string out;
    for (std::size_t at = 0; at < row.size(); ++at) {
        const std::size_t end = row[at] == '{' ? row.find('}', at) : std::string::npos;
        if (end == std::string::npos) {
            out += row[at];
            continue;
        }
        out += values.at(row.substr(at + 1, end - at - 1));
        at = end;
    }
    return out + "\n";
}

struct Logger {
    const char* name;
    const char* head;   // what stands before the records
    const char* row;    // of a record
    const char* holds;  // g a m p q: what is read of it; "": refused
    const char* says;   // in a note, or in the refusal
    const char *columns{""}, *units{""};
    double rate_hz{};
};

const Logger loggers[] = {
    {"phyphox Gyroscope.csv",
     "\"Time (s)\",\"Gyroscope x (rad/s)\",\"Gyroscope y (rad/s)\",\"Gyroscope z (rad/s)\"\n",
     "{e},{gx},{gy},{gz}", "g", ""},
    {"Sensor Logger Gyroscope.csv", "time,seconds_elapsed,z,y,x\n", "{ns},{s},{gz},{gy},{gx}", "g",
     "column 'time'"},
    {"Sensor Logger Orientation.csv", "time,seconds_elapsed,yaw,qx,qz,roll,qw,qy,pitch\n",
     "{ns},{s},1,{qx},{qz},2,{qw},{qy},3", "q", ""},
    {"AndroSensor",
     "ACCELEROMETER X (m/s²);ACCELEROMETER Y (m/s²);ACCELEROMETER Z (m/s²);GRAVITY X (m/s²);LINEAR "
     "ACCELERATION X (m/s²);"
     "GYROSCOPE X (rad/s);GYROSCOPE Y (rad/s);GYROSCOPE Z (rad/s);MAGNETIC FIELD X (μT);MAGNETIC "
     "FIELD Y (μT);"
     "MAGNETIC FIELD Z (μT);ORIENTATION Z (azimuth °);ORIENTATION X (pitch °);ORIENTATION Y (roll "
     "°);Time since start in ms ;"
     "YYYY-MO-DD HH-MI-SS_SSS\n",
     "{ax};{ay};{az};0;{freex};{gx};{gy};{gz};{mx};{my};{mz};10;20;30;{ms};2016-06-28 15-36-29_001",
     "gam", "azimuth"},
    {"MATLAB Mobile Acceleration.csv", "Timestamp,X,Y,Z\n", "02-May-2023 {clock},{ax},{ay},{az}",
     "a", "calendar"},
    {"a clock without a date", "Time,ax (g),ay (g),az (g),gx (deg/s),gy (deg/s),gz (deg/s)\n",
     "{clock},{Gx},{Gy},{Gz},{dpsx},{dpsy},{dpsz}", "ga", "of the day"},
    {"a date of another form", "date;ax;ay;az\n", "5/2/2023 {clock};{ax};{ay};{az}", "", "--rate"},
    {"date and clock in two columns", "Date,Time,ax,ay,az\n", "2023-05-02,{clock},{ax},{ay},{az}",
     "a", "holds no clock"},
    {"Xsens MTw",
     "// DeviceId: "
     "00B42D4F\nPacketCounter\tSampleTimeFine\tYear\tSecond\tAcc_X\tAcc_Y\tAcc_Z\tGyr_X\tGyr_"
     "Y\tGyr_Z\tRoll\n",
     "{i}\tNaN\tNaN\tNaN\t{ax}\t{ay}\t{az}\t{gx}\t{gy}\t{gz}\t3", "", "--rate"},
    {"Xsens MTw with a rate",
     "// DeviceId: "
     "00B42D4F\nPacketCounter\tSampleTimeFine\tYear\tSecond\tAcc_X\tAcc_Y\tAcc_Z\tGyr_X\tGyr_"
     "Y\tGyr_Z\tRoll\n",
     "{i}\tNaN\tNaN\tNaN\t{ax}\t{ay}\t{az}\t{gx}\t{gy}\t{gz}\t3", "ga", "--rate", "", "", 100},
    {"Xsens, quaternion by numbers",
     "Counter\tAcc_X\tAcc_Y\tAcc_Z\tGyr_X\tGyr_Y\tGyr_Z\tOriInc_q0\tOriInc_q1\tQuat_q0\tQuat_"
     "q1\tQuat_q2\tQuat_q3\n",
     "{i}\t{ax}\t{ay}\t{az}\t{gx}\t{gy}\t{gz}\t1\t0\t{qw}\t{qx}\t{qy}\t{qz}", "ga", "numbered", "",
     "", 100},
    {"Xsens DOT",
     "sep=,\nDeviceTag:,7\nOutputRate:,60\nStartTime:,2021\n\nPacketCounter,SampleTimeFine,Quat_W,"
     "Quat_X,Quat_Y,Quat_Z,FreeAcc_X,FreeAcc_Y,FreeAcc_Z\n",
     "{i},{us},{qw},{qx},{qy},{qz},{freex},{freey},{freez}", "q", "gravity has been taken out"},
    {"Shimmer, a field without a unit",
     "S_Timestamp_Unix_CAL\tS_Accel_LN_X_CAL\tS_Accel_LN_Y_CAL\tS_Accel_LN_Z_CAL\tS_Mag_X_CAL\tS_"
     "Mag_Y_CAL\tS_Mag_Z_CAL\t\n"
     "ms\tm/(s^2)\tm/(s^2)\tm/(s^2)\tlocal_flux\tlocal_flux\tlocal_flux\t\n",
     "{ms}\t{ax}\t{ay}\t{az}\t{mx}\t{my}\t{mz}\t", "", "--units mag"},
    {"Shimmer with a factor",
     "S_Timestamp_Unix_CAL\tS_Accel_LN_X_CAL\tS_Accel_LN_Y_CAL\tS_Accel_LN_Z_CAL\tS_Mag_X_CAL\tS_"
     "Mag_Y_CAL\tS_Mag_Z_CAL\t\n"
     "ms\tm/(s^2)\tm/(s^2)\tm/(s^2)\tlocal_flux\tlocal_flux\tlocal_flux\t\n",
     "{ms}\t{ax}\t{ay}\t{az}\t{mx}\t{my}\t{mz}\t", "am", "", "", "mag=1"},
    {"ROS 1 by rostopic",
     "%time,field.header.seq,field.header.stamp,field.angular_velocity.x,field.angular_velocity.y,"
     "field.angular_velocity.z\n",
     "{late},{i},{ns},{gx},{gy},{gz}", "g", "'field.header.stamp'"},
    {"ROS 1 bag by bagpy",
     "Time,header.stamp.secs,header.stamp.nsecs,header.frame_id,orientation.x,orientation.y,"
     "orientation.z,orientation.w,"
     "orientation_covariance_3,angular_velocity.x,angular_velocity.y,angular_velocity.z,angular_"
     "velocity_covariance_3,"
     "linear_acceleration.x,linear_acceleration.y,linear_acceleration.z\n",
     "{s},{sec},{nsec},imu,{qx},{qy},{qz},{qw},0,{gx},{gy},{gz},0,{ax},{ay},{az}", "gaq",
     "header.stamp.nsecs"},
    {"Betaflight's blackbox",
     "loopIteration, time (us), axisP[0], axisP[1], axisP[2], rcCommand[0], gyroADC[0], "
     "gyroADC[1], gyroADC[2], "
     "gyroUnfilt[0], gyroUnfilt[1], gyroUnfilt[2], accSmooth[0], accSmooth[1], accSmooth[2], "
     "debug[0]\n",
     "{i}, {us}, 1, 2, 3, 4, {dpsx}, {dpsy}, {dpsz}, 1, 2, 3, {Gx}, {Gy}, {Gz}, 0", "ga",
     "rcCommand", "", "gyro=deg/s"},
    {"Blackbox explorer",
     "\"Product\",\"Blackbox flight data "
     "recorder\"\n\"looptime\",\"125\"\n\"loopIteration\",\"time\",\"axisP[0]\",\"gyroADC[0]\","
     "\"gyroADC[1]\",\"gyroADC[2]\"\n",
     "{i},{us},1,{gx},{gy},{gz}", "g", "preamble"},
    {"PX4 sensor_combined",
     "timestamp,gyro_rad[0],gyro_rad[1],gyro_rad[2],accelerometer_timestamp_relative,accelerometer_"
     "m_s2[0],"
     "accelerometer_m_s2[1],accelerometer_m_s2[2]\n",
     "{us},{gx},{gy},{gz},0,{ax},{ay},{az}", "ga", "holds no clock"},
    {"PX4 vehicle_attitude", "timestamp,q[0],q[1],q[2],q[3],delta_q_reset[0]\n",
     "{us},{qw},{qx},{qy},{qz},1", "", "--columns"},
    {"ArduPilot IMU", "TimeUS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,EG,T\n",
     "{us},{gx},{gy},{gz},{ax},{ay},{az},0,43.2", "ga", "'T' is not used"},
    {"DatCon",
     "Clock:Tick#,Clock:offsetTime,IMU_ATTI(0):accelX,IMU_ATTI(0):accelY,IMU_ATTI(0):accelZ,IMU_"
     "ATTI(0):gyroX,IMU_ATTI(0):gyroY,IMU_ATTI(0):gyroZ\n",
     "{ticks},{s},{Gx},{Gy},{Gz},{dpsx},{dpsy},{dpsz}", "ga", "gravity in g", "", "gyro=deg/s"},
    {"Motive, one body",
     "Format Version,1.23,Capture Frame Rate,100.000,Rotation Type,Quaternion,Length "
     "Units,Millimeters\n\n,,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid "
     "Body,Rigid Body\n"
     ",,\"1\",\"1\",\"1\",\"1\",\"1\",\"1\",\"1\"\n,,Rotation,Rotation,Rotation,Rotation,Position,"
     "Position,Position\nFrame,Time (Seconds),X,Y,Z,W,X,Y,Z\n",
     "{i},{s},{qx},{qy},{qz},{qw},{mmx},{mmy},{mmz}", "pq", "positions are in mm"},
    {"Motive, two bodies",
     ",,Rotation,Rotation,Rotation,Rotation,Rotation,Rotation,Rotation,Rotation\nFrame,Time "
     "(Seconds),X,Y,Z,W,X,Y,Z,W\n",
     "{i},{s},{qx},{qy},{qz},{qw},{qx},{qy},{qz},{qw}", "", "--columns"},
    {"Motive, two bodies, by columns",
     "Length Units,Millimeters,Version,1.2\nFrame,Time (Seconds),X,Y,Z,X,Y,Z\n",
     "{i},{s},{mmx},{mmy},{mmz},9,9,9", "p", "positions are in mm", "-,t_s,px,py,pz,-,-,-"},
    {"Vicon",
     "Segments\n100\n,,Subject:Root,,,,,\nFrame,Sub "
     "Frame,RX,RY,RZ,TX,TY,TZ\n,,deg,deg,deg,mm,mm,mm\n",
     "{i},0,1,2,3,{mmx},{mmy},{mmz}", "", "--rate"},
    {"Vicon with a rate",
     "Segments\n100\n,,Subject:Root,,,,,\nFrame,Sub "
     "Frame,RX,RY,RZ,TX,TY,TZ\n,,deg,deg,deg,mm,mm,mm\n",
     "{i},0,1,2,3,{mmx},{mmy},{mmz}", "p", "RX", "", "", 100},
    {"a headset, scalar last", "time;device;posX;posY;posZ;rotX;rotY;rotZ;rotW\n",
     "{s};LHR-12;{px};{py};{pz};{qx};{qy};{qz};{qw}", "pq", "device"},
    {"angles for a rotation", "t,PositionX,PositionY,PositionZ,RotationX,RotationY,RotationZ\n",
     "{s},{px},{py},{pz},10,20,30", "", "angles"},
    {"angles beside sensors", "t,ax,ay,az,orientation_x,orientation_y,orientation_z\n",
     "{s},{ax},{ay},{az},10,20,30", "a", "no quaternion"},
    {"MetaBase",
     "epoc (ms),timestamp (+0200),elapsed (s),x-axis (deg/s),y-axis (deg/s),z-axis (deg/s)\n",
     "{ms},2022-06-05T10.11.12,{s},{dpsx},{dpsy},{dpsz}", "g", "epoc"},
    {"ActiGraph",
     "---- Data Table File Created By ActiGraph at 100 Hz ----\nSerial Number: TAS1\nStart Time "
     "12:34:00\nCurrent Memory Address: 0\n"
     "Timestamp,Accelerometer X,Accelerometer Y,Accelerometer Z,Temperature,Gyroscope X,Gyroscope "
     "Y,Gyroscope Z\n",
     "2023-05-02T{clock},{Gx},{Gy},{Gz},25,{dpsx},{dpsy},{dpsz}", "ga", "preamble"},
    {"WIT",
     "StartTime: 2021-03-05 "
     "09:10:11.123\naddress\tTime(s)\tax(g)\tay(g)\taz(g)\twx(deg/s)\twy(deg/s)\twz(deg/"
     "s)\tAngleX(deg)\tT(°)\tq0\tq1\tq2\tq3\n",
     "0x50\t{s}\t{Gx}\t{Gy}\t{Gz}\t{dpsx}\t{dpsy}\t{dpsz}\t1\t25\t{qw}\t{qx}\t{qy}\t{qz}", "ga",
     "numbered"},
    {"names of another language",
     "Zeit (s);Gyro X (°/s);Gyro Y (°/s);Gyro Z (°/s);Beschl. X (m/s²);Beschl. Y (m/s²);Beschl. Z "
     "(m/s²)\n",
     "{s};{dpsx};{dpsy};{dpsz};{ax};{ay};{az}", "ga", "by their unit"},
    {"RealSense", "Motion Module,Gyro,0\n", "{ms},{gx},{gy},{gz}", "", "--columns"},
    {"RealSense by columns", "Motion Module,Gyro,0\n", "{ms},{gx},{gy},{gz}", "g", "preamble",
     "t_ms,gx,gy,gz"},
    {"label and value", "", "ax:{ax},ay:{ay},az:{az}", "", "line of names"},
    {"JSON lines", "", "[ \"t\": {s}, \"gx\": {gx} ]", "", "line of names"},
};

double number(const std::map<std::string, std::string>& values, const std::string& name) {
    return std::stod(values.at(name));
}

void expect_vector(const Vec3& read, const std::map<std::string, std::string>& values,
                   char letter) {
    const std::string l(1, letter);
    EXPECT_NEAR(static_cast<double>(read.x), number(values, l + "x"), 1e-4);
    EXPECT_NEAR(static_cast<double>(read.y), number(values, l + "y"), 1e-4);
    EXPECT_NEAR(static_cast<double>(read.z), number(values, l + "z"), 1e-4);
}

/// Each record holds what `holds` says and nothing else, and its numbers are those of the motion.
void expect_record(const Recording& r, std::size_t i, const std::string& holds) {
    const auto values = values_of(static_cast<int>(i));
    const auto has = [&](char c) { return holds.find(c) != std::string::npos; };
    std::uint32_t flags = 0;
    if (!r.samples.empty()) {
        const Sample& s = r.samples[i];
        if (has('g')) flags |= flag::gyro_valid, expect_vector(s.gyro_rad_s, values, 'g');
        if (has('a')) flags |= flag::accel_valid, expect_vector(s.accel_m_s2, values, 'a');
        if (has('m')) flags |= flag::mag_valid, expect_vector(s.mag_uT, values, 'm');
        EXPECT_EQ(s.flags & (flag::gyro_valid | flag::accel_valid | flag::mag_valid), flags);
        EXPECT_EQ(r.truth.empty(), !has('p') && !has('q'));
    }
    const auto& poses = r.samples.empty() ? r.poses : r.truth;
    if (poses.empty()) return;
    flags = (has('p') ? +flag::position_valid : 0u) | (has('q') ? +flag::orientation_valid : 0u);
    EXPECT_EQ(poses[i].flags & (flag::position_valid | flag::orientation_valid), flags);
    if (has('p')) expect_vector(poses[i].p_w_m, values, 'p');
    if (!has('q')) return;
    EXPECT_NEAR(static_cast<double>(poses[i].q_wb.w), number(values, "qw"), 1e-6);
    EXPECT_NEAR(static_cast<double>(poses[i].q_wb.y), number(values, "qy"), 1e-6);
}

/// The reader's words: notes, or the refusal.
std::string read_as(const Logger& logger, const std::string& text, Recording& out) {
    ReadOptions options;
    options.columns = logger.columns;
    options.units = logger.units;
    options.rate_hz = logger.rate_hz;
    try {
        out = parse_recording(text, std::string(logger.name), options);
    } catch (const BadData& error) {
        return error.what();
    }
    std::string words;
    for (const std::string& note : out.notes) words += note + "\n";
    return words;
}

}  // namespace

TEST(LoggerFiles, EachIsReadAsItWasMeantOrRefusedWithTheRemedy) {
    for (const Logger& logger : loggers) {
        std::string text = logger.head;
        for (int i = 0; i < records; ++i) text += filled(logger.row, values_of(i));
        Recording read;
        const std::string words = read_as(logger, text, read);
        SCOPED_TRACE(std::string(logger.name) + ": " + words);
        EXPECT_NE(words.find(logger.says), std::string::npos);
        if (*logger.holds == 0) {
            EXPECT_EQ(read.size(), 0u);
            continue;
        }
        EXPECT_EQ(read.size(), std::size_t{records});
        for (std::size_t i = 0; i < read.size(); ++i) {
            expect_record(read, i, logger.holds);
            if (i > 0) {
                EXPECT_EQ(read.t_ns(i) - read.t_ns(i - 1), 10000000);
            }
            if (HasFailure()) break;
        }
        if (HasFailure()) break;
    }
}

TEST(LoggerFiles, AClockOfTheDayGoesOnAfterMidnight) {
    const std::string text =
        "time,ax,ay,az\n23:59:59.990,0,0,9.8\n00:00:00.000,0,0,9.8\n00:00:00.010,0,0,9.8\n";
    const Recording read = parse_recording(text, "x");
    ASSERT_EQ(read.size(), 3u);
    EXPECT_EQ(read.t_ns(1) - read.t_ns(0), 10000000);
    EXPECT_EQ(read.t_ns(2), 86400010000000);
}

TEST(LoggerFiles, ADateBesideATimeInAnotherUnitLeavesThatUnitAlone) {
    std::string text = "when,t [ms],ax,ay,az\n";
    for (int i = 0; i < records; ++i)
        text += filled("2023-05-02 {clock},{ms},{ax},{ay},{az}", values_of(i));
    const Recording read = parse_recording(text, "x");
    ASSERT_EQ(read.size(), std::size_t{records});
    EXPECT_EQ(read.t_ns(1) - read.t_ns(0), 10000000);
}

TEST(LoggerFiles, AHeaderBelowRecordsThatHaveOneIsNoPreamble) {
    std::string text = "t_s,ax,ay,az\n";
    for (int i = 0; i < 50; ++i) text += filled("{s},{ax},{ay},{az}", values_of(i));
    text += "t_s,gx,gy,gz\n";
    for (int i = 50; i < 99; ++i) text += filled("{s},{gx},{gy},{gz}", values_of(i));
    EXPECT_THROW(parse_recording(text, "x"), BadData) << "another table begins there";
}
