// ${ name }$_axis_tb: self-checking bench of ${ name }$_axis
//
// To run it, copy the files of both folders into one directory and use any simulator, for example
//   $ iverilog -g2012 -s ${ name }$_axis_tb -o sim ${ name }$*.v
//   $ ./sim
// or, with Verilator 5,
//   $ verilator --binary --timing --top ${ name }$_axis_tb ${ name }$*.v
//   $ obj_dir/V${ name }$_axis_tb
// The bench sends the points of the core's bench and compares the transfers that come back. In
// turn, neither side pauses, the sender pauses, the receiver pauses, and both pause. A second reset
// in the middle starts the sequence again. Inputs change on the falling edge of the clock. Outputs
// are read just before the rising edge.
//
// Generated files belong to their user, without conditions.

`default_nettype none

module ${ name }$_axis_tb #(
    parameter SENT_FILE     = "${ name }$_sent.mem",
    parameter RECEIVED_FILE = "${ name }$_received.mem"
);
    localparam SENT     = ${ sent }$;
    localparam RECEIVED = ${ received }$;
    localparam PASSES   = ${ passes }$;  // how often the bench sends all transfers
    localparam PAUSE    = ${ pause }$;  // the most clocks of one pause
    localparam TURN     = 6 * PAUSE;  // clocks until the next combination of pausing sides
    localparam ABORTED  = 7 * TURN / 2;  // the clock of the second reset
    localparam LIMIT    = ${ limit }$;  // the most clocks without a transfer
    localparam USER     = ${ user_bits }$;
    localparam REPORTED = 20;  // the number of differences to print

    reg [${ in_high }$:0] sent [0:SENT-1];
    reg [${ word_high }$:0] received [0:RECEIVED-1];
    reg [${ word_high }$:0] want;

    reg aclk = 1'b0;
    reg aresetn = 1'b0;
    reg [${ in_high }$:0] s_axis_tdata;
<%- if keep %>
    reg [${ in_high / 8 }$:0] s_axis_tkeep;
<%- endif %>
    reg [${ user_bits - 1 }$:0] s_axis_tuser;
<%- if !is_line %>
    reg s_axis_tlast;
<%- endif %>
    reg s_axis_tvalid = 1'b0;
    wire s_axis_tready;
    wire [${ out_high }$:0] m_axis_tdata;
<%- if keep %>
    wire [${ out_high / 8 }$:0] m_axis_tkeep;
<%- endif %>
    wire [${ user_bits - 1 }$:0] m_axis_tuser;
    wire m_axis_tlast;
    wire m_axis_tvalid;
    reg m_axis_tready = 1'b0;

    ${ name }$_axis dut (
        .aclk(aclk),
        .aresetn(aresetn),
<%- for port in table_ports %>
        ${ port }$
<%- endfor %>
        .s_axis_tdata(s_axis_tdata),
<%- if keep %>
        .s_axis_tkeep(s_axis_tkeep),
<%- endif %>
        .s_axis_tuser(s_axis_tuser),
<%- if !is_line %>
        .s_axis_tlast(s_axis_tlast),
<%- endif %>
        .s_axis_tvalid(s_axis_tvalid),
        .s_axis_tready(s_axis_tready),
        .m_axis_tdata(m_axis_tdata),
<%- if keep %>
        .m_axis_tkeep(m_axis_tkeep),
<%- endif %>
        .m_axis_tuser(m_axis_tuser),
        .m_axis_tlast(m_axis_tlast),
        .m_axis_tvalid(m_axis_tvalid),
        .m_axis_tready(m_axis_tready)
    );

    // The initial values are set here: ${ name }$_tb.v says why.
    integer clock = 0;
    integer offered = 0;  // the number of the next transfer to be sent
    integer taken = 0;  // the number of the next transfer to be received
    integer source = 0;  // the number of the sent transfer that it belongs to
    integer sender_pauses = 0;
    integer receiver_pauses = 0;
    integer waited = 0;
    integer errors = 0;
    reg was_reset = 1'b0;
    reg was_offered = 1'b0;
    reg accepted = 1'b0;
    reg [${ offer_high }$:0] offer = 0;
    reg over = 1'b0;
    reg [31:0] random = 32'd1;

    // The marks of transfer `number`: the top bit is its tlast, and repetitions of all bits its
    // tuser.
    function [31:0] marks(input integer number);
        marks = (number + 1) * 32'h9e3779b1;
    endfunction
    wire [31:0] sent_marks = marks(offered);
    wire [31:0] taken_marks = marks(source);
    wire [${ 32 * user_words - 1 }$:0] sent_users = {${ user_words }${sent_marks}};
    wire [${ 32 * user_words - 1 }$:0] taken_users = {${ user_words }${taken_marks}};

    task check(input right, input string what);
        if (right !== 1'b1) begin
            if (errors < REPORTED) begin
                $display("clock %0d, transfer %0d: %0s", clock, taken, what);
            end
            errors = errors + 1;
        end
    endtask

    initial begin
        $readmemh(SENT_FILE, sent);
        $readmemh(RECEIVED_FILE, received);
        while (!over) begin
            aresetn = clock > 1 && clock != ABORTED;
            random = {random[30:0], random[31] ^ random[21] ^ random[1] ^ random[0]};
            if (sender_pauses > 0) sender_pauses = sender_pauses - 1;
            else if (clock / TURN % 2 == 1 && random[3:0] == 0) begin
                sender_pauses = {16'd0, random[19:4]} % PAUSE;
            end
            if (receiver_pauses > 0) receiver_pauses = receiver_pauses - 1;
            else if (clock / TURN % 4 > 1 && random[8:5] == 0) begin
                receiver_pauses = {16'd0, random[30:15]} % PAUSE;
            end
            if (accepted) begin
                s_axis_tvalid = 1'b0;
                offered = offered + 1;
            end
            accepted = 1'b0;
            if (!aresetn) begin
                offered = 0;
                taken = 0;
                source = 0;
                s_axis_tvalid = 1'b0;
            end else if (offered < PASSES * SENT && sender_pauses == 0) begin
                s_axis_tvalid = 1'b1;
            end
            m_axis_tready = receiver_pauses == 0;
            #1;
            // While tvalid is low, the other signals carry wrong values, which must not matter.
            s_axis_tdata = s_axis_tvalid ? sent[offered % SENT] : ~sent[0];
<%- if keep %>
            s_axis_tkeep = {${ in_high / 8 + 1 }${s_axis_tvalid}};
<%- endif %>
            s_axis_tuser = sent_users[${ user_bits - 1 }$:0] ^ {USER{!s_axis_tvalid}};
<%- if !is_line %>
            s_axis_tlast = sent_marks[31] == s_axis_tvalid;
<%- endif %>
            #3;
            if (was_reset) check(!m_axis_tvalid, "an offer after the reset");
            if (aresetn && !was_reset && clock > 2) begin
                check(s_axis_tready !== 1'bx && m_axis_tvalid !== 1'bx, "an unknown handshake");
                if (was_offered) begin
                    check(m_axis_tvalid && {m_axis_tuser, m_axis_tlast, m_axis_tdata} === offer,
                            "an offer that changes");
                end
            end
            offer = {m_axis_tuser, m_axis_tlast, m_axis_tdata};
            was_offered = aresetn && m_axis_tvalid && !m_axis_tready;
            was_reset = !aresetn && clock > 0;
            waited = waited + 1;
            if (aresetn && m_axis_tvalid && m_axis_tready) begin
                check(taken < PASSES * RECEIVED, "a transfer too many");
                if (taken < PASSES * RECEIVED) begin
                    waited = 0;
                    want = received[taken % RECEIVED];
                    check(m_axis_tdata === want[${ out_high }$:0], "m_axis_tdata");
<%- if keep %>
                    check(&m_axis_tkeep === 1'b1, "m_axis_tkeep");
<%- endif %>
                    check(m_axis_tuser === taken_users[${ user_bits - 1 }$:0], "m_axis_tuser");
<%- if is_line %>
                    check(m_axis_tlast === want[${ out_high + 1 }$], "m_axis_tlast");
                    if (want[${ out_high + 1 }$]) source = source + 1;
<%- else %>
                    check(m_axis_tlast === taken_marks[31], "m_axis_tlast");
                    source = source + 1;
<%- endif %>
                end
                taken = taken + 1;
            end
            if (s_axis_tvalid && s_axis_tready === 1'b1) begin
                waited = 0;
                accepted = 1'b1;
            end
            over = waited > LIMIT || taken >= PASSES * RECEIVED && waited > PAUSE;
            clock = clock + 1;
            #1 aclk = 1'b1;
            #5 aclk = 1'b0;
        end
        if (taken < PASSES * RECEIVED) begin
            $display("clock %0d: nothing moves after transfer %0d", clock, taken);
            errors = errors + 1;
        end
        if (errors != 0) begin
            $display("FAIL ${ name }$_axis: %0d differences in %0d clocks",
                errors, clock);
            $fatal;
        end
        $display("PASS ${ name }$_axis: %0d transfers in %0d clocks, no difference",
            taken, clock);
        $finish;
    end
endmodule

`default_nettype wire
