"""The calls of stub.cpp, made with smbus2. usage: stub.py /dev/i2c-N ADDRESS"""
import sys

from smbus2 import SMBus, i2c_msg

bus = SMBus(sys.argv[1])
a = int(sys.argv[2], 0)
data = list(range(100, 133))


def say(call, f):
    try:
        r = f()
    except ValueError:
        print(call, "-> refused")
        return
    except OSError as e:
        print(call, "-> errno", e.errno)
        return
    if r is None:
        r = "ok"
    print(call, "->", " ".join(map(str, r)) if isinstance(r, list) else r)


print("funcs %08x" % int(bus.funcs))
say("write_quick", lambda: bus.write_quick(a))
say("write_byte_data 0x75 0x68", lambda: bus.write_byte_data(a, 0x75, 0x68))
say("read_byte_data 0x75", lambda: bus.read_byte_data(a, 0x75))
say("write_word_data 0x40 0xBEEF", lambda: bus.write_word_data(a, 0x40, 0xBEEF))
say("read_word_data 0x40", lambda: bus.read_word_data(a, 0x40))
say("read_byte_data 0x40", lambda: bus.read_byte_data(a, 0x40))
say("write_byte 0x75", lambda: bus.write_byte(a, 0x75))
say("read_byte", lambda: bus.read_byte(a))
say("write_i2c_block_data 14", lambda: bus.write_i2c_block_data(a, 0x3B, data[:14]))
say("read_i2c_block_data 14", lambda: bus.read_i2c_block_data(a, 0x3B, 14))
say("read_i2c_block_data 32", lambda: bus.read_i2c_block_data(a, 0x30, 32))
say("read_i2c_block_data 33", lambda: bus.read_i2c_block_data(a, 0x30, 33))
say("write_i2c_block_data 33", lambda: bus.write_i2c_block_data(a, 0x30, data))
say("write_block_data 33", lambda: bus.write_block_data(a, 0x30, data))
say("read_block_data", lambda: bus.read_block_data(a, 0x3B))
say("write_block_data 3", lambda: bus.write_block_data(a, 0x60, data[:3]))
say("process_call", lambda: bus.process_call(a, 0x10, 0x1234))
say("block_process_call", lambda: bus.block_process_call(a, 0x10, data[:4]))
say("absent read_byte_data", lambda: bus.read_byte_data(0x22, 0))
say("absent write_quick", lambda: bus.write_quick(0x22))
try:
    bus.i2c_rdwr(i2c_msg.read(a, 2))
    print("i2c_rdwr -> ?")
except OSError as e:
    print("i2c_rdwr ->", "unsupported" if e.errno == 95 else e.errno)
