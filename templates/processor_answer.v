    wire valid;
    wire busy;
<%- for line in module.result_wires %>
    ${ line }$
<%- endfor %>

    // Whether the function id names an instruction in the list above.
<%- for line in module.known %>
${ line }$
<%- endfor %>

    // The upper bits of the function id select the result.
    reg  [31:0] answer;
    always @* begin
        case (taken[9:4])
<%- for answer in module.answers %>
            ${ answer.number }$: answer = ${ answer.word }$;
<%- endfor %>
            default: answer = 32'd0;
        endcase
    end
