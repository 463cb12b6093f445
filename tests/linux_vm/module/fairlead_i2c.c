// SPDX-License-Identifier: MIT OR GPL-2.0
/*
 * An I2C adapter whose devices live in user space: whoever opens /dev/fairlead-i2c answers the
 * transfers, so a sensor model with a real FIFO can stand behind the kernel's own i2c-dev and behind
 * its own sensor drivers. One transfer at a time, as on a wire; each carries a number, so that an
 * answer that comes too late is told from the answer to the next one.
 *
 * read():   u32 number; u32 n; n * { u16 address, flags, length, 0 }; what the write messages carry
 * write():  u32 number; s32 n or -errno; what the read messages get
 * poll():   readable while a transfer waits
 *
 * The parameter "client" binds a kernel driver: "TYPE ADDRESS GPIO" makes an I2C device with the
 * GPIO's interrupt, as a device tree would; GPIO 0 stands for none.
 */
#include <linux/delay.h>
#include <linux/gpio.h>
#include <linux/i2c.h>
#include <linux/miscdevice.h>
#include <linux/module.h>
#include <linux/poll.h>
#include <linux/slab.h>
#include <linux/uaccess.h>
#include <linux/wait.h>

#define BUFFER_SIZE 32768
#define REPLY_HEADER 8

static DEFINE_MUTEX(lock);
static DECLARE_WAIT_QUEUE_HEAD(queue);
static u8 *buffer;
static size_t request_size;
static bool waiting, answered, served;
static u32 number;
static struct i2c_msg *messages;
static int message_count, result;
static int timeout_ms = 1000;
module_param(timeout_ms, int, 0644);

struct message_head {
	u16 address, flags, length, zero;
};

static int pack(struct i2c_msg *m, int n)
{
	size_t at = 8 + n * sizeof(struct message_head);
	int i;

	((u32 *)buffer)[0] = ++number;
	((u32 *)buffer)[1] = n;
	for (i = 0; i < n; i++) {
		struct message_head *h = (struct message_head *)(buffer + 8) + i;

		h->address = m[i].addr;
		h->flags = m[i].flags;
		h->length = m[i].len;
		h->zero = 0;
		if (m[i].flags & I2C_M_RD)
			continue;
		if (at + m[i].len > BUFFER_SIZE)
			return -EMSGSIZE;
		memcpy(buffer + at, m[i].buf, m[i].len);
		at += m[i].len;
	}
	request_size = at;
	return 0;
}

static int transfer(struct i2c_adapter *adapter, struct i2c_msg *m, int n)
{
	int status;

	mutex_lock(&lock);
	status = served ? pack(m, n) : -ENXIO;
	if (status) {
		mutex_unlock(&lock);
		return status;
	}
	messages = m;
	message_count = n;
	answered = false;
	waiting = true;
	mutex_unlock(&lock);
	wake_up_all(&queue);
	wait_event_timeout(queue, answered, msecs_to_jiffies(timeout_ms));
	mutex_lock(&lock);
	status = answered ? result : -ETIMEDOUT;
	waiting = false;
	messages = NULL;
	mutex_unlock(&lock);
	return status;
}

static u32 functions(struct i2c_adapter *adapter)
{
	return I2C_FUNC_I2C | I2C_FUNC_SMBUS_EMUL;
}

static const struct i2c_algorithm algorithm = {
	.master_xfer = transfer,
	.functionality = functions,
};
static struct i2c_adapter adapter = {
	.owner = THIS_MODULE,
	.name = "fairlead-i2c",
	.algo = &algorithm,
};

static ssize_t dev_read(struct file *f, char __user *user, size_t size, loff_t *pos)
{
	ssize_t done;

	if (wait_event_interruptible(queue, waiting))
		return -ERESTARTSYS;
	mutex_lock(&lock);
	done = request_size;
	if (!waiting)
		done = -EAGAIN;
	else if (size < request_size)
		done = -EMSGSIZE;
	else if (copy_to_user(user, buffer, request_size))
		done = -EFAULT;
	waiting = false;
	mutex_unlock(&lock);
	return done;
}

static ssize_t unpack(const char __user *user, size_t size)
{
	size_t at = REPLY_HEADER;
	u32 head[2];
	int i;

	if (size < REPLY_HEADER || size > BUFFER_SIZE || copy_from_user(head, user, sizeof(head)))
		return -EFAULT;
	if (!messages || head[0] != number)
		return -EPIPE; /* too late */
	for (i = 0; (s32)head[1] >= 0 && i < message_count; i++) {
		if (!(messages[i].flags & I2C_M_RD))
			continue;
		if (at + messages[i].len > size ||
		    copy_from_user(messages[i].buf, user + at, messages[i].len))
			return -EINVAL;
		at += messages[i].len;
	}
	result = (s32)head[1];
	answered = true;
	return size;
}

static ssize_t dev_write(struct file *f, const char __user *user, size_t size, loff_t *pos)
{
	ssize_t done;

	mutex_lock(&lock);
	done = unpack(user, size);
	mutex_unlock(&lock);
	wake_up_all(&queue);
	return done;
}

static __poll_t dev_poll(struct file *f, poll_table *table)
{
	poll_wait(f, &queue, table);
	return waiting ? EPOLLIN : 0;
}

static int dev_open(struct inode *inode, struct file *f)
{
	served = true;
	return 0;
}

static int dev_release(struct inode *inode, struct file *f)
{
	served = false;
	return 0;
}

static const struct file_operations operations = {
	.owner = THIS_MODULE,
	.open = dev_open,
	.release = dev_release,
	.read = dev_read,
	.write = dev_write,
	.poll = dev_poll,
};
static struct miscdevice device = {
	.minor = MISC_DYNAMIC_MINOR,
	.name = "fairlead-i2c",
	.fops = &operations,
};

static struct i2c_client *client;

/*
 * The kernel's ICM-426xx driver binds by device tree only and Debian's amd64 kernel has none. It is
 * lent a table of names, and its device a firmware node that says which part it is.
 */
static const struct i2c_device_id icm_names[] = { { "icm42605" }, {} };

static const void *icm_part(const struct fwnode_handle *node, const struct device *dev)
{
	return (void *)3; /* ICM42605 in the driver's own count */
}
static int no_strings(const struct fwnode_handle *node, const char *name, const char **value,
		      size_t n)
{
	return -EINVAL;
}
static int no_numbers(const struct fwnode_handle *node, const char *name, unsigned int size,
		      void *value, size_t n)
{
	return -EINVAL;
}
static const struct fwnode_operations icm_operations = {
	.device_get_match_data = icm_part,
	.property_read_string_array = no_strings,
	.property_read_int_array = no_numbers,
};
static struct fwnode_handle icm_node;

static void lend_names(struct i2c_board_info *info)
{
	struct device_driver *driver = driver_find("inv-icm42600-i2c", &i2c_bus_type);

	if (!driver)
		return;
	to_i2c_driver(driver)->id_table = icm_names;
	fwnode_init(&icm_node, &icm_operations);
	info->fwnode = &icm_node;
}

static int set_client(const char *text, const struct kernel_param *param)
{
	struct i2c_board_info info = {};
	unsigned int address, gpio;

	if (client && !IS_ERR(client))
		i2c_unregister_device(client);
	client = NULL;
	if (sscanf(text, "%19s %i %u", info.type, &address, &gpio) != 3)
		return 0; /* anything else only removes the last one */
	info.addr = address;
	info.irq = gpio ? gpio_to_irq(gpio) : 0;
	if (!strcmp(info.type, icm_names[0].name))
		lend_names(&info);
	client = i2c_new_client_device(&adapter, &info);
	return PTR_ERR_OR_ZERO(client);
}
static const struct kernel_param_ops client_ops = { .set = set_client };
module_param_cb(client, &client_ops, NULL, 0200);

static int __init start(void)
{
	int status;

	buffer = kzalloc(BUFFER_SIZE, GFP_KERNEL);
	if (!buffer)
		return -ENOMEM;
	status = misc_register(&device);
	if (status)
		goto no_device;
	status = i2c_add_adapter(&adapter);
	if (!status)
		return 0;
	misc_deregister(&device);
no_device:
	kfree(buffer);
	return status;
}

static void __exit stop(void)
{
	if (client && !IS_ERR(client))
		i2c_unregister_device(client);
	i2c_del_adapter(&adapter);
	misc_deregister(&device);
	kfree(buffer);
}

module_init(start);
module_exit(stop);
MODULE_DESCRIPTION("I2C devices in user space, for tests");
MODULE_LICENSE("Dual MIT/GPL");
