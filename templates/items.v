<%- for spaced in items %>
<%- if spaced.gap %>
<% endif %>
<%- match spaced.item %>
<%- when Item::Assign with (lines) %>
<%- for line in lines %>
${ line }$
<%- endfor %>
<%- when Item::Case with { comment, declaration, select, arms, default } %>
<%- for line in comment %>
${ line }$
<%- endfor %>
<%- for line in declaration %>
${ line }$
<%- endfor %>
    always @* begin
        case (${ select }$)
<%- for line in arms %>
${ line }$
<%- endfor %>
<%- for line in default %>
${ line }$
<%- endfor %>
        endcase
    end
<%- when Item::Rom with (rom) %>
<%- for line in rom.comment %>
${ line }$
<%- endfor %>
<%- if !rom.second %>
<%- match rom.contents %>
<%- when Contents::Case with (choices) %>
    function ${ rom.range }$ ${ rom.memory }$;
        input ${ rom.number }$ ${ rom.at }$;
        case (${ rom.at }$)
<%- for line in choices %>
${ line }$
<%- endfor %>
        endcase
    endfunction
<%- when Contents::File with { radix, parameter } %>
    ${ rom.attribute }$reg ${ rom.range }$ ${ rom.memory }$ [0:${ rom.last }$];
    initial $readmem${ radix }$(${ parameter }$, ${ rom.memory }$);
<%- when Contents::Inline with (words) %>
    ${ rom.attribute }$reg ${ rom.range }$ ${ rom.memory }$ [0:${ rom.last }$];
    initial begin
<%- for line in words %>
${ line }$
<%- endfor %>
    end
<%- endmatch %>
<%- endif %>
<%- for line in rom.read %>
${ line }$
<%- endfor %>
<%- when Item::Instance with { declaration, instance } %>
<%- for line in declaration %>
${ line }$
<%- endfor %>
    ${ instance.module }$ #(
<%- for line in instance.parameters %>
        ${ line }$
<%- endfor %>
    ) ${ instance.name }$ (
<%- for line in instance.connections %>
        ${ line }$
<%- endfor %>
    );
<%- endmatch %>
<%- endfor %>