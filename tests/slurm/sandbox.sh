#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Starts or stops a complete Slurm 22.05 (Debian 12) on one host, without systemd and control groups, for tests.
# Requires slurm-wlm, munge and root. Usage: sandbox.sh start|stop FOLDER PORT [NODES] [CPUS]
# Listens only on 127.0.0.1, at PORT (controller) and the NODES ports from PORT + 1 on.
set -eu
command=$1 base=$2 port=${3:-16817} nodes=${4:-1} cpus=${5:-4}
host=$(hostname -s)
export SLURM_CONF=$base/etc/slurm.conf

configure() {
    mkdir -p "$base"/{etc,run,log,state,munge}
    chmod 700 "$base/munge"
    for n in $(seq "$nodes"); do
        mkdir -p "$base/spool/n$n" "$base/tmp/n$n"
        chmod 1777 "$base/tmp/n$n"
    done
    [ -s "$base/munge/munge.key" ] || (umask 077 && head -c 128 /dev/urandom >"$base/munge/munge.key")
    # cred_expire: a requeued job waits this number of seconds instead of two minutes.
    cat >"$SLURM_CONF" <<EOF
ClusterName=sandbox
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
AuthType=auth/munge
CryptoType=crypto/munge
AuthInfo=socket=$base/run/munge.sock,cred_expire=5
SlurmctldPort=$port
SlurmctldPidFile=$base/run/slurmctld.pid
SlurmdPidFile=$base/run/slurmd.%n.pid
StateSaveLocation=$base/state
SlurmdSpoolDir=$base/spool/%n
TmpFS=$base/tmp/%n
SlurmctldLogFile=$base/log/slurmctld.log
SlurmdLogFile=$base/log/slurmd.%n.log
MailProg=/bin/true
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/filetxt
JobCompLoc=$base/log/jobcomp.txt
SchedulerType=sched/backfill
SchedulerParameters=bf_interval=1,sched_min_interval=100000,batch_sched_delay=0
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
MpiDefault=pmix
ReturnToService=2
KillWait=5
SlurmctldTimeout=30
SlurmdTimeout=30
InactiveLimit=0
Waittime=0
SlurmdParameters=config_overrides
EOF
    for n in $(seq "$nodes"); do
        echo "NodeName=n$n NodeHostname=$host NodeAddr=127.0.0.1 Port=$((port + n)) CPUs=$cpus" \
            "Boards=1 SocketsPerBoard=1 CoresPerSocket=$cpus ThreadsPerCore=1 RealMemory=2000"
    done >>"$SLURM_CONF"
    echo "PartitionName=debug Nodes=ALL Default=YES MaxTime=INFINITE State=UP" >>"$SLURM_CONF"
}

case $command in
start)
    configure
    munged --socket="$base/run/munge.sock" --key-file="$base/munge/munge.key" \
        --log-file="$base/log/munged.log" --pid-file="$base/run/munged.pid" \
        --seed-file="$base/munge/munged.seed" --origin=127.0.0.1
    slurmctld
    sleep 1
    for n in $(seq "$nodes"); do slurmd -N "n$n"; done
    for _ in $(seq 600); do
        [ "$(sinfo -h -o %T | sort -u)" = idle ] && exit 0
        sleep 0.5
    done
    echo "Slurm's nodes do not come up: see $base/log" >&2
    exit 1
    ;;
stop)
    for file in "$base"/run/slurmd.*.pid "$base/run/slurmctld.pid" "$base/run/munged.pid"; do
        [ -f "$file" ] && kill "$(cat "$file")" || true
    done
    ;;
esac
